#include "engine/base/error.hpp"

#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

constexpr int kFirst = 1;
constexpr int kLast = 16;

TEST(ErrorCodeName, IsTheGrpcNameOfEveryCode) {
  const std::map<int, std::string> names{{1, "CANCELLED"},
                                         {2, "UNKNOWN"},
                                         {3, "INVALID_ARGUMENT"},
                                         {4, "DEADLINE_EXCEEDED"},
                                         {5, "NOT_FOUND"},
                                         {6, "ALREADY_EXISTS"},
                                         {7, "PERMISSION_DENIED"},
                                         {8, "RESOURCE_EXHAUSTED"},
                                         {9, "FAILED_PRECONDITION"},
                                         {10, "ABORTED"},
                                         {11, "OUT_OF_RANGE"},
                                         {12, "UNIMPLEMENTED"},
                                         {13, "INTERNAL"},
                                         {14, "UNAVAILABLE"},
                                         {15, "DATA_LOSS"},
                                         {16, "UNAUTHENTICATED"}};
  for (int code = kFirst; code <= kLast; ++code) {
    EXPECT_EQ(error_code_name(static_cast<ErrorCode>(code)), names.at(code));
  }
}

TEST(ErrorCodeName, HasAWordForANumberThatIsNoCode) {
  EXPECT_EQ(error_code_name(static_cast<ErrorCode>(0)), "UNKNOWN");
  EXPECT_EQ(error_code_name(static_cast<ErrorCode>(-1)), "UNKNOWN");
  EXPECT_EQ(error_code_name(static_cast<ErrorCode>(17)), "UNKNOWN");
}

TEST(ExitStatus, IsWhatScriptsArePromised) {
  EXPECT_EQ(exit_status(ErrorCode::kInternal), 1);
  EXPECT_EQ(exit_status(ErrorCode::kAlreadyExists), 2);
  EXPECT_EQ(exit_status(ErrorCode::kNotFound), 3);
  EXPECT_EQ(exit_status(ErrorCode::kDataLoss), 5);
  EXPECT_EQ(exit_status(ErrorCode::kUnimplemented), 6);
  EXPECT_EQ(exit_status(ErrorCode::kInvalidArgument), 7);
  EXPECT_EQ(exit_status(ErrorCode::kOutOfRange), 7);
  EXPECT_EQ(exit_status(ErrorCode::kUnavailable), 8);
  EXPECT_EQ(exit_status(ErrorCode::kDeadlineExceeded), 8);
  EXPECT_EQ(exit_status(ErrorCode::kPermissionDenied), 9);
  EXPECT_EQ(exit_status(ErrorCode::kUnauthenticated), 9);
  EXPECT_EQ(exit_status(ErrorCode::kCancelled), 130);
}

TEST(ExitStatus, OfAnErrorIsNeverZeroAndAlwaysOneOfThePromised) {
  const std::set<int> promised{1, 2, 3, 4, 5, 6, 7, 8, 9, 130};
  for (int code = kFirst - 2; code <= kLast + 2; ++code) {
    EXPECT_TRUE(promised.contains(exit_status(static_cast<ErrorCode>(code)))) << code;
  }
}

TEST(Error, CarriesCodeSentenceAndField) {
  const Error plain(ErrorCode::kNotFound, "there is no scene 'a'");
  EXPECT_EQ(plain.code(), ErrorCode::kNotFound);
  EXPECT_STREQ(plain.what(), "there is no scene 'a'");
  EXPECT_EQ(plain.field(), "");
  const Error with_field(ErrorCode::kInvalidArgument, "ratio is 7", "ratio");
  EXPECT_EQ(with_field.field(), "ratio");
}

}  // namespace
}  // namespace landmarkdb
