#include "store/utf8.hpp"

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(TakeCharacter, TakesOneToFourBytes) {
  std::string_view text = "aü入😀";
  for (const std::uint32_t want : {0x61U, 0xfcU, 0x5165U, 0x1f600U}) {
    EXPECT_EQ(take_character(text), want);
  }
  EXPECT_TRUE(text.empty());
}

TEST(TakeCharacter, TakesNothingFromBytesThatAreNoCharacter) {
  for (std::string_view text :
       {"\x80", "\xc1\x81", "\xe2\x82", "\xed\xbf\xbf", "\xf8\x88\x80\x80"}) {
    const std::size_t size = text.size();
    EXPECT_EQ(take_character(text), std::nullopt);
    EXPECT_EQ(text.size(), size);
  }
}

TEST(ValidUtf8, ReplacesOnlyWhatIsNotValid) {
  EXPECT_EQ(valid_utf8("Größe"), "Größe");
  EXPECT_EQ(valid_utf8(""), "");
  EXPECT_EQ(valid_utf8("a\xff"
                       "b\xe2\x82"),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd\xef\xbf\xbd");
}

}  // namespace
}  // namespace landmarkdb
