#include "engine/geometry/quantise.hpp"

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

TEST(Quantise, ComesBackWithinHalfAStep) {
  Random random(1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i) {
    points.emplace_back(static_cast<float>(random.uniform(-5.0, 30.0)),
                        static_cast<float>(random.uniform(100.0, 101.0)),
                        static_cast<float>(random.uniform(-2.0, 2.0)));
  }
  const QuantisedPoints quantised = quantise(points);
  EXPECT_EQ(quantised.bytes.size(), 6 * points.size());
  EXPECT_NEAR(quantised.scale_m, 17.5 / 32767.0, 1e-5);
  const std::vector<Eigen::Vector3f> back = dequantise(quantised);
  ASSERT_EQ(back.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((back[i] - points[i]).cwiseAbs().maxCoeff(), 0.5 * quantised.scale_m + 1e-5);
  }
}

TEST(Quantise, HoldsNoPointsOnePointAndPointsAtOneSpot) {
  EXPECT_TRUE(quantise({}).bytes.empty());
  const std::vector<Eigen::Vector3f> one = {{1.0F, 2.0F, 3.0F}};
  EXPECT_EQ(dequantise(quantise(one)), one);
  const std::vector<Eigen::Vector3f> same(3, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  EXPECT_GT(quantise(same).scale_m, 0.0);
  EXPECT_EQ(dequantise(quantise(same)), same);
}

TEST(Quantise, IsLittleEndian) {
  const std::vector<Eigen::Vector3f> points = {{-1.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}};
  const std::string& bytes = quantise(points).bytes;
  EXPECT_EQ(bytes.substr(0, 2), std::string("\x01\x80", 2));  // -32767
  EXPECT_EQ(bytes.substr(6, 2), std::string("\xFF\x7F", 2));  // 32767
}

}  // namespace
}  // namespace landmarkdb
