#include "store/sha256.hpp"

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

// The values are those of FIPS 180-4's examples.
TEST(Sha256, GivesTheStandardsExamples) {
  EXPECT_EQ(sha256_of(std::string("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(std::string()),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, IsTheSameInPieces) {
  const std::string text(100'000, 'q');
  const auto bytes = std::as_bytes(std::span(text));
  Sha256 digest;
  digest.update(bytes.first(1));
  digest.update(bytes.subspan(1, 70'000));
  digest.update(bytes.subspan(70'001));
  EXPECT_EQ(digest.finish(), sha256_of(text));
}

}  // namespace
}  // namespace landmarkdb
