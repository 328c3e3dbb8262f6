#include "store/arrays.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;

TEST(Arrays, VectorsAndIndicesComeBackBitForBit) {
  const std::vector<Eigen::Vector3f> vectors{{0.1F, -2.5F, 1e-30F}, {-0.0F, 3e8F, 7.0F}};
  EXPECT_EQ(bytes_of(vectors).size(), 24U);
  EXPECT_EQ(vectors_from(bytes_of(vectors)), vectors);
  const std::vector<std::uint16_t> indices{0, 1, 65535};
  EXPECT_EQ(indices_from(bytes_of(indices)), indices);
  EXPECT_TRUE(vectors_from(bytes_of(std::vector<Eigen::Vector3f>{})).empty());
}

TEST(Arrays, RotationsComeBackAsTheSameRotation) {
  Random random(3);
  std::vector<Eigen::Matrix3f> rotations;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    rotations.emplace_back(q.normalized().toRotationMatrix().cast<float>());
  }
  // Half a turn about each axis: w is zero there.
  for (const Eigen::Vector3f& axis :
       {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, 0, 1)}) {
    rotations.emplace_back(Eigen::AngleAxisf(static_cast<float>(M_PI), axis).toRotationMatrix());
  }
  const auto back = frames_from(quaternions_of(rotations, "scene"), "scene");
  ASSERT_EQ(back.size(), rotations.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_LT((back[i] - rotations[i]).cwiseAbs().maxCoeff(), 1e-6F) << i;
    EXPECT_NEAR(back[i].determinant(), 1.0F, 1e-5F);
  }
}

TEST(Arrays, WhatIsNoRotationIsRefused) {
  const Eigen::Matrix3f mirror = Eigen::Vector3f(1, 1, -1).asDiagonal();
  for (const Eigen::Matrix3f& matrix : {mirror,
                                        Eigen::Matrix3f(2 * Eigen::Matrix3f::Identity()),
                                        Eigen::Matrix3f(Eigen::Matrix3f::Zero())}) {
    EXPECT_EQ(error_of([&] { quaternions_of({matrix}, "scene"); }).code,
              ErrorCode::kInvalidArgument);
  }
  const Bytes zeros(16);
  EXPECT_EQ(error_of([&] { frames_from(zeros, "scene"); }).code, ErrorCode::kDataLoss);
  const Bytes nans(16, std::byte{0xff});
  EXPECT_EQ(error_of([&] { frames_from(nans, "scene"); }).code, ErrorCode::kDataLoss);
}

TEST(Arrays, DescriptorsLoseAtMostTheRoundingOfHalves) {
  Random random(5);
  constexpr std::size_t kRow = 352;
  std::vector<float> values(kRow * 10);
  for (std::size_t begin = 0; begin < values.size(); begin += kRow) {
    Eigen::Map<Eigen::VectorXf> row(values.data() + begin, kRow);
    for (float& value : row) value = static_cast<float>(std::pow(random.uniform(), 4.0));
    row.normalize();
  }
  const auto back = unit_rows_from(halves_of(values, "scene"), kRow);
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t begin = 0; begin < values.size(); begin += kRow) {
    const Eigen::Map<const Eigen::VectorXf> row(back.data() + begin, kRow);
    const Eigen::Map<const Eigen::VectorXf> want(values.data() + begin, kRow);
    EXPECT_NEAR(row.norm(), 1.0F, 1e-6F);
    EXPECT_LT((row - want).norm(), 5e-4F);
  }
}

TEST(Arrays, ARowOfZerosStaysSo) {
  const std::vector<float> zeros(352, 0.0F);
  EXPECT_EQ(unit_rows_from(halves_of(zeros, "scene"), 352), zeros);
}

TEST(Arrays, ValuesPastTheRangeOfHalvesAreRefused) {
  for (const float value : {1e6F, -70000.0F, std::nanf(""), HUGE_VALF}) {
    EXPECT_EQ(error_of([&] { halves_of({value}, "scene"); }).code, ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace landmarkdb
