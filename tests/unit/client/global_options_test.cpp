#include "client/global_options.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

class ReadToken : public ::testing::Test {
 protected:
  ~ReadToken() override { std::filesystem::remove(path_); }
  std::string written(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }
  std::string path_ = ::testing::TempDir() + "landmarkdb_token_" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ReadToken, TakesTheFirstLineWithoutItsBlanks) {
  EXPECT_EQ(read_token(written("  s3cret \r\nsecond\n")), "s3cret");
  EXPECT_EQ(read_token(written("bare")), "bare");
}

TEST_F(ReadToken, RefusesEmptyOverlongAndMissingFiles) {
  EXPECT_THROW(read_token(written("\nsecond\n")), Error);
  EXPECT_THROW(read_token(written(std::string(5000, 'x'))), Error);
  EXPECT_THROW(read_token("/nowhere/token"), Error);
}

}  // namespace
}  // namespace landmarkdb::client
