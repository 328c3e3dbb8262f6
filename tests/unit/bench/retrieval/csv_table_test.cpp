#include "bench/retrieval/csv_table.hpp"

#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

using testing::ElementsAre;

CsvTable read(const std::string& text) {
  std::istringstream in(text);
  return read_csv(in, "runs.csv");
}

std::string complaint(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "none";
}

std::string number_complaint(const std::string& number) {
  const CsvTable table = read("a,margin\n1," + number + "\n");
  try {
    csv_number(table, table.rows[0], 1);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(ReadCsv, SkipsRemarksAndEmptyLinesButCountsThem) {
  const CsvTable table = read("# seed 1\na,b\r\n1,2\r\n#funnel x,y,z\n\n3,\n");
  EXPECT_THAT(table.columns, ElementsAre("a", "b"));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(table.rows[0].fields, ElementsAre("1", "2"));
  EXPECT_THAT(table.rows[1].fields, ElementsAre("3", ""));
  EXPECT_EQ(table.rows[0].line, 3U);
  EXPECT_EQ(table.rows[1].line, 6U);
}

TEST(ReadCsv, FindsColumnsByName) {
  const CsvTable table = read("a,b\n");
  EXPECT_EQ(table.find("b"), 1U);
  EXPECT_EQ(table.find("c"), 2U);
}

TEST(ReadCsv, RefusesAFileWithoutAHeader) {
  EXPECT_EQ(complaint(""), "runs.csv: empty, want a line that names the columns");
  EXPECT_EQ(complaint("# only this\n"), "runs.csv: empty, want a line that names the columns");
}

TEST(ReadCsv, RefusesAColumnThatComesTwice) {
  EXPECT_EQ(complaint("a,b,a\n"), "runs.csv:1: column 'a' comes twice, want each name once");
}

TEST(ReadCsv, RefusesARowOfAnotherLength) {
  EXPECT_EQ(complaint("a,b\n1,2\n1\n"), "runs.csv:3: 1 fields, want 2 as in the header");
  EXPECT_EQ(complaint("a,b\n1,2,3\n"), "runs.csv:2: 3 fields, want 2 as in the header");
}

TEST(ReadCsvFile, NamesTheFileThatCannotBeRead) {
  EXPECT_THROW(read_csv_file("/nowhere/runs.csv"), Error);
  EXPECT_THROW(read_csv_file(std::filesystem::temp_directory_path().string()), Error);
}

TEST(CsvNumber, ReadsWholeFieldsOnly) {
  const CsvTable table = read("a\n-1.5e2\n");
  EXPECT_DOUBLE_EQ(csv_number(table, table.rows[0], 0), -150.0);
  for (const std::string text : {"", "x", "1.5x", " 1", "nan", "inf", "1e999"}) {
    EXPECT_EQ(number_complaint(text), "runs.csv:2: margin is '" + text + "', want a finite number");
  }
}

}  // namespace

}  // namespace landmarkdb::bench
