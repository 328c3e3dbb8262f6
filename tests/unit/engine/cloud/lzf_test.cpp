#include "engine/cloud/lzf.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

bool unpack(const std::string& packed, std::string& out) {
  return lzf_decompress(testing::as_bytes(packed), std::as_writable_bytes(std::span<char>(out)));
}

TEST(Lzf, CopiesLiteralsAndBackReferences) {
  // "abc", then 5 bytes from 3 back (overlapping), then 9 + 2 from 1 back by a long length.
  const std::string packed(
      "\x02"
      "abc"
      "\x60\x02"
      "\xe0\x02\x00",
      9);
  std::string out(3 + 5 + 11, '?');
  ASSERT_TRUE(unpack(packed, out));
  EXPECT_EQ(out, "abcabcab" + std::string(11, 'b'));
}

TEST(Lzf, RefusesWhatWouldLeaveItsBounds) {
  std::string out(8, '?');
  EXPECT_FALSE(unpack(std::string("\x20\x00", 2), out)) << "before the start";
  EXPECT_FALSE(
      unpack("\x05"
             "abc",
             out))
      << "literals that are not there";
  EXPECT_FALSE(
      unpack("\x08"
             "abcdefghi",
             out))
      << "more than fits";
  EXPECT_FALSE(unpack(std::string("\x00"
                                  "a\xe0",
                                  3),
                      out))
      << "no length byte";
  EXPECT_FALSE(unpack(std::string("\x00"
                                  "a\x20",
                                  3),
                      out))
      << "no distance byte";
  EXPECT_FALSE(
      unpack("\x00"
             "a",
             out))
      << "less than wanted";
}

}  // namespace
}  // namespace landmarkdb
