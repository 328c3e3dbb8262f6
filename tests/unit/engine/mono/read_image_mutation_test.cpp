#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/mono/read_image.hpp"
#include "tests/unit/engine/cloud/allocation_watch.hpp"
#include "tests/unit/engine/mono/image_files.hpp"

// Reads images that were valid before something happened to them. Whatever happened, the reader
// either returns an image or throws an Error, and never asks for more memory than the file's size
// warrants.
namespace landmarkdb {
namespace {

constexpr std::size_t kMostMemory = 8U << 20U;  // the files have some kilobytes
constexpr std::uint64_t kMostPixels = 4'000'000;

bool survives(const std::string& bytes, const std::string& name) {
  testing::reset_largest_allocation();
  bool accepted = false;
  try {
    const GreyImage image =
        parse_image(std::as_bytes(std::span(bytes)), name, {.max_pixels = kMostPixels});
    EXPECT_GT(image.pixels.size(), 0U);
    EXPECT_EQ(image.pixels.size(), std::size_t{image.width} * image.height);
    EXPECT_LE(image.pixels.size(), kMostPixels);
    accepted = true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << error.what();
  }
  EXPECT_LE(testing::largest_allocation(), kMostMemory) << name;
  return accepted;
}

std::string damage(std::string file, Random& random) {
  const std::size_t at = random.below(file.size());
  switch (random.below(4)) {
    case 0: {
      file[at] = static_cast<char>(file[at] ^ (1 << random.below(8)));
      return file;
    }
    case 1:
      return file.substr(0, at);
    case 2: {
      const std::size_t head = random.below(std::min<std::size_t>(file.size(), 200));
      file[head] = static_cast<char>(random.below(256));  // the header, where most harm is done
      return file;
    }
    default: {
      const std::size_t length = random.below(std::min<std::size_t>(64, file.size() - at) + 1);
      const std::string piece = file.substr(at, length);
      if (random.below(2) == 0) file.erase(at, length);
      return file.insert(random.below(file.size() + 1), piece);
    }
  }
}

class ReadImageMutation : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ReadImageMutation, EndsInAnImageOrAnError) {
  const testing::NamedImage file = testing::one_image_of_each()[GetParam()];
  ASSERT_TRUE(survives(file.bytes, file.name));
  constexpr int kRounds = 1500;
  Random random(GetParam() + 1);
  int accepted = 0;
  for (int round = 0; round < kRounds; ++round) {
    accepted += survives(damage(file.bytes, random), file.name) ? 1 : 0;
    if (HasFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(accepted, 0);        // harmless changes pass
  EXPECT_LT(accepted, kRounds);  // harmful ones do not
}

INSTANTIATE_TEST_SUITE_P(OneOfEach,
                         ReadImageMutation,
                         ::testing::Range<std::size_t>(0, testing::one_image_of_each().size()));

}  // namespace
}  // namespace landmarkdb
