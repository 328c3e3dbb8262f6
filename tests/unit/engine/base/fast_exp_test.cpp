#include "engine/base/fast_exp.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(ExpOfNegative, IsTheExponentialToThreePartsInTenMillion) {
  EXPECT_EQ(exp_of_negative(0.0F), 1.0F);
  for (float x = 0.0F; x > -86.0F; x -= 0.00731F) {
    const double expected = std::exp(static_cast<double>(x));
    // The argument itself has 2^-24 of its size: what that makes of the result is not counted.
    const double tolerance = 3e-7 + 2e-7 * std::abs(static_cast<double>(x));
    EXPECT_NEAR(exp_of_negative(x) / expected, 1.0, tolerance) << x;
  }
}

TEST(ExpOfNegative, EndsInNextToNothing) {
  EXPECT_LT(exp_of_negative(-100.0F), 1e-37F);
  EXPECT_GE(exp_of_negative(-std::numeric_limits<float>::infinity()), 0.0F);
  EXPECT_LT(exp_of_negative(-std::numeric_limits<float>::max()), 1e-37F);
}

}  // namespace
}  // namespace landmarkdb
