#include "cli/table.hpp"

#include <gtest/gtest.h>

namespace landmarkdb::cli {
namespace {

TEST(Table, AlignsColumnsToTheirWidestCell) {
  Table table({{"NAME"}, {"POINTS", Align::kRight}});
  table.add({"lobby", "7"});
  table.add({"a", "12345678"});
  EXPECT_EQ(table.text(),
            "NAME     POINTS\n"
            "lobby         7\n"
            "a      12345678\n");
}

TEST(Table, CountsCodePointsNotBytes) {
  Table table({{"NAME"}, {"N"}});
  table.add({"Bühne", "1"});
  table.add({"Saal1", "2"});
  EXPECT_EQ(table.text(), "NAME   N\nBühne  1\nSaal1  2\n");
}

TEST(Table, LetsNoControlCharacterThrough) {
  Table table({{"NAME"}});
  table.add({"\033[2Jgone\n"});
  EXPECT_EQ(table.text(), "NAME\n?[2Jgone?\n");
}

TEST(Printable, LeavesTextAsItIsAndNoControlIn) {
  EXPECT_EQ(printable("Bühne 日本 \xF0\x9F\x9A\xAA"), "Bühne 日本 \xF0\x9F\x9A\xAA");
  EXPECT_EQ(printable("a\tb\x7F\x1B]0;title\x07"), "a?b??]0;title?");
  EXPECT_EQ(printable("\xC2\x9B[2J"),
            "?"
            "?[2J")
      << "U+009B starts a command, too";
  EXPECT_EQ(printable("\x9B[2J"), "?[2J");
  EXPECT_EQ(printable("\xE6\x97"), "??") << "cut off in a character";
  EXPECT_EQ(printable("\xC0\x9B\xFF"), "???");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, KeepsLinesWhereTheyAreMeant) {
  EXPECT_EQ(printable_lines("a\n\033b\n\nc"), "a\n?b\n\nc");
  EXPECT_EQ(printable_lines("a\r\n"), "a?\n");
}

TEST(Table, PrintsOnlyTheHeaderWithoutRows) {
  EXPECT_EQ(Table({{"NAME"}, {"N"}}).text(), "NAME  N\n");
}

TEST(BytesText, ChoosesTheUnit) {
  EXPECT_EQ(bytes_text(0), "0 B");
  EXPECT_EQ(bytes_text(1023), "1023 B");
  EXPECT_EQ(bytes_text(1536), "1.5 KiB");
  EXPECT_EQ(bytes_text(std::uint64_t{3} << 40U), "3.0 TiB");
  EXPECT_EQ(bytes_text(std::uint64_t{5000} << 40U), "5000.0 TiB");
}

TEST(CountText, GroupsDigitsByThree) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(1000), "1,000");
  EXPECT_EQ(count_text(2798245), "2,798,245");
}

TEST(Counted, KnowsThePlural) {
  EXPECT_EQ(counted(1, "scene"), "1 scene");
  EXPECT_EQ(counted(0, "scene"), "0 scenes");
  EXPECT_EQ(counted(1234, "scene"), "1,234 scenes");
}

}  // namespace
}  // namespace landmarkdb::cli
