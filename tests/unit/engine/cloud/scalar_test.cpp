#include "engine/cloud/scalar.hpp"

#include <array>
#include <string>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(ParseNumber, ReadsWhatScannersWrite) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+2"), 2.0);
  EXPECT_EQ(parse_number("-3.25e-2"), -0.0325);
  EXPECT_EQ(parse_number("525."), 525.0);
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_TRUE(std::isnan(parse_number("nan").value_or(0)));
  EXPECT_TRUE(std::isnan(parse_number("-nan").value_or(0)));
  EXPECT_TRUE(std::isinf(parse_number("-inf").value_or(0)));
  EXPECT_TRUE(std::isinf(parse_number("1e999").value_or(0)));
  EXPECT_EQ(parse_number("1e-999"), 0.0);
}

TEST(ParseNumber, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "+", "-", "+-1", "1,5", "1.5x", "x", "0x10", "1 2", "--1", "1e"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(ParseCount, TakesDigitsOnly) {
  EXPECT_EQ(parse_count("0"), 0U);
  EXPECT_EQ(parse_count("18446744073709551615"), 18'446'744'073'709'551'615U);
  for (const char* text : {"", "-1", "+1", "1.0", "1e3", "18446744073709551616", " 1"}) {
    EXPECT_FALSE(parse_count(text)) << text;
  }
}

TEST(LoadScalar, ReadsEveryTypeInBothByteOrders) {
  const std::array<std::byte, 8> bytes{std::byte{0xc0},
                                       std::byte{0x01},
                                       std::byte{0x02},
                                       std::byte{0x03},
                                       std::byte{0x04},
                                       std::byte{0x05},
                                       std::byte{0x06},
                                       std::byte{0x40}};
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kUint8, true), 0xc0);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kInt8, true), -0x40);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kUint16, true), 0xc001);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kUint16, false), 0x01c0);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kInt32, true), -0x3ffefdfd);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kUint32, false), 0x030201c0);
  EXPECT_EQ(load_scalar(bytes.data(), ScalarType::kUint64, false), 0x1p62 + 0x0006050403'0201c0);
  const std::array<std::byte, 4> one{std::byte{0x3f}, std::byte{0x80}, std::byte{0}, std::byte{0}};
  EXPECT_EQ(load_scalar(one.data(), ScalarType::kFloat32, true), 1.0);
}

TEST(ToFloat, TurnsWhatDoesNotFitIntoInfinity) {
  EXPECT_EQ(to_float(0.5), 0.5F);
  EXPECT_EQ(to_float(1e300), std::numeric_limits<float>::infinity());
  EXPECT_EQ(to_float(-1e300), -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(to_float(std::nan(""))));
}

}  // namespace
}  // namespace landmarkdb
