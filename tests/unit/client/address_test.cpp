#include "client/address.hpp"

#include <string>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

TEST(ParseAddress, ReadsHostAndPort) {
  const Address address = parse_address("robot.local:9000");
  EXPECT_EQ(address.host, "robot.local");
  EXPECT_EQ(address.port, "9000");
  EXPECT_TRUE(address.path.empty());
}

TEST(ParseAddress, TakesTheDefaultPortWhereNoneIsGiven) {
  EXPECT_EQ(parse_address("robot").port, "7071");
  EXPECT_EQ(parse_address("[::1]").port, "7071");
}

TEST(ParseAddress, ReadsIpv6InBrackets) {
  const Address address = parse_address("[fe80::1]:80");
  EXPECT_EQ(address.host, "fe80::1");
  EXPECT_EQ(address.port, "80");
}

TEST(ParseAddress, ReadsUnixPaths) {
  EXPECT_EQ(parse_address("unix:/run/a:b.sock").path, "/run/a:b.sock");
}

class ParseAddressRefuses : public ::testing::TestWithParam<std::string> {};

TEST_P(ParseAddressRefuses, WithTheTextSeen) {
  try {
    parse_address(GetParam());
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(exit_status(error.code()), 2);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("'" + GetParam() + "'"));
  }
}

INSTANTIATE_TEST_SUITE_P(BadAddresses,
                         ParseAddressRefuses,
                         ::testing::Values("",
                                           ":7071",
                                           "host:",
                                           "host:0",
                                           "host:65536",
                                           "host:http",
                                           "host:-1",
                                           "::1:80",
                                           "[::1",
                                           "[::1]80",
                                           "unix:",
                                           "unix:/" + std::string(120, 'x')));

}  // namespace
}  // namespace landmarkdb::client
