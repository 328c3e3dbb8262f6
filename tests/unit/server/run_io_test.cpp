#include "server/run_io.hpp"

#include <sstream>
#include <stdexcept>

#include <boost/asio/post.hpp>
#include <gmock/gmock.h>

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;

TEST(RunIo, NamesAHandlerThatThrowsAndRunsTheOthers) {
  std::ostringstream text;
  Logger log(text, LogLevel::kInfo, false);
  boost::asio::io_context io;
  int done = 0;
  boost::asio::post(io, [] { throw std::runtime_error("no luck"); });
  boost::asio::post(io, [] { throw 3; });
  boost::asio::post(io, [&] { ++done; });
  run_io(io, log);
  EXPECT_EQ(done, 1);
  EXPECT_THAT(text.str(), HasSubstr("a handler failed reason=\"no luck\""));
}

}  // namespace
}  // namespace landmarkdb
