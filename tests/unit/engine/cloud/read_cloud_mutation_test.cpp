#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "tests/unit/engine/cloud/allocation_watch.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

// Reads files that were valid before something happened to them. Whatever happened, the reader
// either returns a cloud or throws an Error, and never asks for more memory than the file's size
// warrants.
namespace landmarkdb {
namespace {

constexpr std::size_t kMostMemory = 8U << 20U;  // the files have some kilobytes
constexpr std::uint64_t kMostPoints = 2'000;

// Throws what parse_cloud should not throw; returns whether the file was accepted.
bool survives(const std::string& bytes, const std::string& name) {
  testing::reset_largest_allocation();
  bool accepted = false;
  try {
    const PointCloud cloud =
        testing::parse(bytes, name, {.max_points = kMostPoints, .mesh_spacing_m = 0.0});
    EXPECT_LE(cloud.size(), kMostPoints);
    EXPECT_GT(cloud.size(), 0U);
    EXPECT_TRUE(cloud.normals.empty() || cloud.normals.size() == cloud.size());
    EXPECT_TRUE(cloud.colours.empty() || cloud.colours.size() == cloud.size());
    EXPECT_TRUE(cloud.viewpoint_index.empty() || cloud.viewpoint_index.size() == cloud.size());
    accepted = true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << error.what();
  }
  EXPECT_LE(testing::largest_allocation(), kMostMemory) << name;
  return accepted;
}

std::string flip_bits(std::string file, Random& random) {
  for (std::uint64_t n = 1 + random.below(4); n > 0; --n) {
    char& byte = file[random.below(file.size())];
    byte = static_cast<char>(byte ^ (1 << random.below(8)));
  }
  return file;
}

std::string cut(std::string file, Random& random) {
  file.resize(random.below(file.size()));
  return file;
}

// Numbers of the header and of text become others, huge ones among them.
std::string change_digits(std::string file, Random& random) {
  static constexpr std::array<std::string_view, 8> kNumbers{
      "0", "-1", "4294967296", "1000000000000", "18446744073709551615", "nan", "1e308", "99"};
  const std::size_t start = random.below(file.size());
  const std::size_t at = file.find_first_of("0123456789", start);
  if (at == std::string::npos) return file;
  const std::size_t end = std::min(file.find_first_not_of("0123456789", at), file.size());
  return file.replace(at, end - at, kNumbers[random.below(kNumbers.size())]);
}

std::string splice(std::string file, Random& random) {
  const std::size_t from = random.below(file.size());
  const std::size_t length = random.below(std::min<std::size_t>(64, file.size() - from) + 1);
  const std::string piece = file.substr(from, length);
  if (random.below(2) == 0) file.erase(from, length);
  return file.insert(random.below(file.size() + 1), piece);
}

class ReadCloudMutation : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ReadCloudMutation, EndsInACloudOrAnError) {
  const testing::NamedFile file = testing::one_of_each()[GetParam()];
  ASSERT_TRUE(survives(file.bytes, file.name));
  constexpr int kRounds = 1500;
  Random random(GetParam() + 1);
  int accepted = 0;
  for (int round = 0; round < kRounds; ++round) {
    std::string bytes = file.bytes;
    switch (random.below(4)) {
      case 0:
        bytes = flip_bits(std::move(bytes), random);
        break;
      case 1:
        bytes = cut(std::move(bytes), random);
        break;
      case 2:
        bytes = change_digits(std::move(bytes), random);
        break;
      default:
        bytes = splice(std::move(bytes), random);
        break;
    }
    accepted += survives(bytes, file.name) ? 1 : 0;
    if (HasFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(accepted, 0);        // harmless changes pass
  EXPECT_LT(accepted, kRounds);  // harmful ones do not
}

INSTANTIATE_TEST_SUITE_P(OneOfEach,
                         ReadCloudMutation,
                         ::testing::Range<std::size_t>(0, testing::one_of_each().size()));

}  // namespace
}  // namespace landmarkdb
