#include "engine/base/run_context.hpp"

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;

// The error that `job` ends with; fails the test when it ends without.
template <typename Job>
Error error_of(const Job& job) {
  try {
    job();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error";
  return {ErrorCode::kUnknown, ""};
}

TEST(RunContext, LetsAJobRunThatNobodyStops) {
  const RunContext context;
  EXPECT_FALSE(context.should_stop());
  EXPECT_NO_THROW(context.check("match"));
  EXPECT_NO_THROW(context.report("match", 1, 2));
}

TEST(RunContext, NamesTheStageThatWasStopped) {
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_NO_THROW(context.check("describe"));
  stop.request_stop();
  EXPECT_TRUE(context.should_stop());
  const Error error = error_of([&] { context.check("describe"); });
  EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  EXPECT_THAT(error.what(), HasSubstr("describe"));
}

TEST(RunContext, NamesTheStageThatRanPastTheDeadline) {
  RunContext context;
  context.deadline = steady_clock::now() + std::chrono::hours(1);
  EXPECT_NO_THROW(context.check("icp"));
  context.deadline = steady_clock::now();
  EXPECT_TRUE(context.should_stop());
  const Error error = error_of([&] { context.check("icp"); });
  EXPECT_EQ(error.code(), ErrorCode::kDeadlineExceeded);
  EXPECT_THAT(error.what(), HasSubstr("icp"));
}

TEST(RunContext, SaysStoppedWhenItIsBothStoppedAndLate) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  context.deadline = steady_clock::now();
  EXPECT_EQ(error_of([&] { context.check("icp"); }).code(), ErrorCode::kCancelled);
}

TEST(RunContext, TellsHowFarItIsBeforeItStops) {
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  std::vector<std::string> told;
  context.progress = [&](const Progress& progress) {
    told.push_back(std::string(progress.stage) + " " + std::to_string(progress.done) + "/" +
                   std::to_string(progress.total));
    if (progress.done == 2) stop.request_stop();  // from inside the callback
  };
  context.report("index", 1, 3);
  EXPECT_EQ(error_of([&] { context.report("index", 2, 3); }).code(), ErrorCode::kCancelled);
  EXPECT_EQ(told, (std::vector<std::string>{"index 1/3", "index 2/3"}));
}

}  // namespace
}  // namespace landmarkdb
