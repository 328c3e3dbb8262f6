#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/matching/filters.hpp"

namespace landmarkdb {
namespace {

struct Pairs {
  std::vector<Eigen::Vector3f> query, target;
  std::vector<Correspondence> correspondences;
  std::size_t right = 0;  // the first so many are right
};

Eigen::Vector3f random_point(Random& random) {
  return Eigen::Vector3d(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3))
      .cast<float>();
}

Pairs make_pairs(const Eigen::Vector3f& translation,
                 std::size_t right,
                 std::size_t wrong,
                 double noise_m,
                 std::uint64_t seed) {
  Random random(seed);
  Pairs pairs;
  pairs.right = right;
  for (std::size_t i = 0; i < right + wrong; ++i) {
    const Eigen::Vector3f p = random_point(random);
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    pairs.query.push_back(p);
    pairs.target.push_back(i < right
                               ? Eigen::Vector3f(p + translation + (noise_m * noise).cast<float>())
                               : random_point(random));
    pairs.correspondences.push_back(
        {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i), 0.0F});
  }
  return pairs;
}

struct Left {
  std::size_t right = 0, wrong = 0;
};

Left filter(const Pairs& pairs, const SlopeOptions& options) {
  Left left;
  for (const Correspondence& pair :
       filter_slope(pairs.correspondences, pairs.target, pairs.query, options)) {
    (pair.query < pairs.right ? left.right : left.wrong) += 1;
  }
  return left;
}

TEST(FilterSlope, KeepsTheRightPairsAndDropsMostOfTheWrong) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Pairs pairs = make_pairs({1.5F, -0.8F, 0.4F}, 60, 40, 0.03, seed);
    const Left left = filter(pairs, {});
    EXPECT_GE(left.right, 55U) << seed;
    EXPECT_LE(left.wrong, 8U) << seed;
  }
}

// A fit to all pairs would be a fit to the wrong ones, and let none of the right ones through.
TEST(FilterSlope, FindsTheFewRightPairsAmongManyWrong) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Pairs pairs = make_pairs({6.0F, -3.0F, 2.0F}, 20, 380, 0.05, seed);
    const Left left = filter(pairs, {});
    EXPECT_GE(left.right, 18U) << seed;
    EXPECT_LE(left.wrong, 60U) << seed;
  }
}

// dx = 0 is a pole of the slope, and angles on either side of it are neighbours.
TEST(FilterSlope, HasNoPole) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Pairs pairs = make_pairs({0.0F, 2.0F, 1.5F}, 60, 30, 0.03, seed);
    const Left left = filter(pairs, {});
    EXPECT_GE(left.right, 55U) << seed;
    EXPECT_LE(left.wrong, 8U) << seed;
  }
}

TEST(FilterSlope, KeepsPairsThatAllAgreeAndPairsWithoutASlope) {
  const Pairs exact = make_pairs({1, 2, 3}, 50, 0, 0.0, 1);
  EXPECT_EQ(filter(exact, {}).right, 50U);
  const Pairs still = make_pairs({0, 0, 0}, 50, 0, 0.0, 2);
  EXPECT_EQ(filter(still, {}).right, 50U);
  const Pairs noisy = make_pairs({2, 2, 2}, 50, 0, 0.02, 3);
  EXPECT_EQ(filter(noisy, {}).right, 50U);
  EXPECT_TRUE(filter_slope({}, {}, {}, {}).empty());
}

TEST(FilterSlope, KeepsTheOrder) {
  const Pairs pairs = make_pairs({1.5F, -0.8F, 0.4F}, 40, 40, 0.03, 7);
  const auto kept = filter_slope(pairs.correspondences, pairs.target, pairs.query, {});
  EXPECT_TRUE(std::is_sorted(
      kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.query < b.query; }));
}

TEST(FilterSlope, MeansNothingForCloudsThatAreTurned) {
  Pairs pairs = make_pairs({1.5F, -0.8F, 0.4F}, 60, 0, 0.0, 1);
  for (Eigen::Vector3f& p : pairs.query) p = Eigen::Vector3f(-p.y(), p.x(), p.z());
  EXPECT_LT(filter(pairs, {}).right, 30U);
}

TEST(FilterSlope, RefusesIndicesOutsideAndOptionsThatCannotBe) {
  const Pairs pairs = make_pairs({1, 1, 1}, 5, 0, 0.0, 1);
  const std::vector<Correspondence> outside = {{0, 5, 0.0F}};
  EXPECT_THROW(filter_slope(outside, pairs.target, pairs.query, {}), Error);
  const std::vector<Correspondence> outside_query = {{9, 0, 0.0F}};
  EXPECT_THROW(filter_slope(outside_query, pairs.target, pairs.query, {}), Error);
  EXPECT_THROW(filter_slope(pairs.correspondences, pairs.target, pairs.query, {.max_sigma = 0.0}),
               Error);
  EXPECT_THROW(
      filter_slope(pairs.correspondences, pairs.target, pairs.query, {.min_sigma_rad = NAN}),
      Error);
  EXPECT_THROW(
      filter_slope(pairs.correspondences, pairs.target, pairs.query, {.start_reach_rad = 0.0}),
      Error);
}

}  // namespace
}  // namespace landmarkdb
