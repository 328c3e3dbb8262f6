#include "engine/mono/four_metric.hpp"

#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

struct Body {
  std::vector<SearchModel> models;
  FourIndex index;
  explicit Body(std::uint64_t seed)
      : models{prepare_model(testing::make_mono_model({.seed = seed, .types = 1}))},
        index(models) {}
  FourIndex::Group paths() const { return index.group(FourShape::kPath, 0); }
};

Eigen::Matrix3d some_rotation(Random& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

// A four of the body under scaled orthography, one metre away.
std::array<Eigen::Vector2d, 4> seen(const Body& body,
                                    const ModelFour& four,
                                    const Eigen::Matrix3d& R) {
  std::array<Eigen::Vector2d, 4> rays;
  for (std::size_t k = 0; k < 4; ++k)
    rays[k] = (R * body.models[0].points[four.ids[k]].xyz).head<2>();
  return rays;
}

bool is_hit(const std::vector<FourHit>& hits, std::size_t four) {
  return std::any_of(
      hits.begin(), hits.end(), [&](const FourHit& hit) { return hit.model_four == four; });
}

TEST(FourMetric, PassesTheFourThatIsSeenFromAnySideAndSaysItsSize) {
  const Body body(7);
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const std::size_t which = body.paths().first + random.below(body.paths().size);
    if (*body.index.metric(0, which) == 0.0F) continue;  // filled up
    std::vector<FourHit> hits;
    test_fours(body.index,
               body.paths(),
               four_products(seen(body, body.index[which], some_rotation(random))),
               0.01F,
               hits);
    ASSERT_TRUE(is_hit(hits, which));
    for (const FourHit& hit : hits) {
      if (hit.model_four == which) {
        EXPECT_NEAR(hit.size, 2.0F, 0.02F);
      }
    }
  }
}

TEST(FourMetric, PassesFewOthers) {
  const Body body(7);
  Random random(2);
  std::size_t tested = 0, passed = 0;
  for (int round = 0; round < 300; ++round) {
    std::array<Eigen::Vector2d, 4> rays;
    for (Eigen::Vector2d& ray : rays) ray = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    std::vector<FourHit> hits;
    test_fours(body.index, body.paths(), four_products(rays), 0.15F, hits);
    tested += body.paths().size;
    passed += hits.size();
  }
  EXPECT_GT(passed, 0U);
  EXPECT_LT(passed * 50, tested);
}

TEST(FourMetric, PassesNoFourThatFillsAGroupUp) {
  const Body body(8);
  std::vector<FourHit> hits;
  test_fours(body.index, body.paths(), FourProducts{}, 1.0F, hits);
  EXPECT_TRUE(hits.empty());
}

TEST(FourMetric, DependsNeitherOnShiftNorScaleNorTurnInTheImage) {
  const Body body(9);
  Random random(3);
  const std::size_t which = body.paths().first + 5;
  std::array<Eigen::Vector2d, 4> rays = seen(body, body.index[which], some_rotation(random));
  const Eigen::Matrix2d turn = 0.37 * Eigen::Rotation2Dd(1.1).toRotationMatrix();
  for (Eigen::Vector2d& ray : rays) ray = turn * ray + Eigen::Vector2d(0.2, -0.1);
  std::vector<FourHit> hits;
  test_fours(body.index, body.paths(), four_products(rays), 0.01F, hits);
  EXPECT_TRUE(is_hit(hits, which));
}

TEST(FourMetric, IsTheSameOnAllInstructionSets) {
  constexpr std::size_t kCount = 40 * FourIndex::kLanes;
  Random random(4);
  std::array<std::vector<float>, 6> planes;
  std::array<const float*, 6> metric{};
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < kCount; ++i)
      planes[k].push_back(static_cast<float>(random.uniform(-1.0, 1.0)));
    metric[k] = planes[k].data();
  }
  std::array<Eigen::Vector2d, 4> rays;
  for (Eigen::Vector2d& ray : rays) ray = {random.normal(), random.normal()};
  const auto passes_by = [&](const char* name) {
    std::vector<std::uint8_t> passes(kCount, 7);
    four_kernel(name)(metric.data(), kCount, four_products(rays), 0.5F, passes.data());
    return passes;
  };
  const std::vector<std::uint8_t> base = passes_by("sse2");
  EXPECT_GT(std::count(base.begin(), base.end(), 255), 0);
  EXPECT_GT(std::count(base.begin(), base.end(), 0), 0);
  for (const char* name : {"avx2", "avx512"}) {
    if (four_kernel(name) != nullptr) {
      EXPECT_EQ(passes_by(name), base) << name;
    }
  }
  EXPECT_EQ(four_kernel("none"), nullptr);
}

}  // namespace
}  // namespace landmarkdb
