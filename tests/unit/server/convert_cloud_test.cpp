#include "server/convert_cloud.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <zstd.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;

template <typename Number>
std::string raw(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

v1::Cloud float_cloud(const std::vector<float>& numbers) {
  v1::Cloud cloud;
  cloud.set_encoding(v1::POINT_ENCODING_FLOAT32);
  cloud.set_points(numbers.size() / 3);
  cloud.set_xyz(raw(numbers));
  return cloud;
}

PointCloud decode(const v1::Cloud& cloud, std::uint64_t points = 1000) {
  PointAllowance allowance{points};
  return from_proto(cloud, allowance, "clouds[0]");
}

// The error that `cloud` gives; a failure when there is none.
Error refusal(const v1::Cloud& cloud, std::uint64_t points = 1000) {
  try {
    decode(cloud, points);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "was taken: " << cloud.ShortDebugString();
  return {ErrorCode::kUnknown, ""};
}

TEST(CloudFromProto, KeepsFloatsAsTheyAreInvalidOnesToo) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const PointCloud cloud = decode(float_cloud({1.5F, -2.0F, 3.25F, nan, nan, nan}));
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1.5F, -2.0F, 3.25F));
  EXPECT_TRUE(std::isnan(cloud.points[1].x()));
  EXPECT_TRUE(cloud.viewpoints.empty());
}

TEST(CloudFromProto, ScalesFixedPointAndMarksInvalidPoints) {
  v1::Cloud message;
  message.set_encoding(v1::POINT_ENCODING_INT16);
  message.set_points(2);
  message.set_xyz(raw<std::int16_t>({1000, -2000, 32767, 5, -32768, 5}));
  message.set_scale_m(0.001);
  message.mutable_offset_m()->set_x(10.0);
  const PointCloud cloud = decode(message);
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_LT((cloud.points[0] - Eigen::Vector3f(11.0F, -2.0F, 32.767F)).norm(), 1e-5F);
  EXPECT_TRUE(cloud.points[1].hasNaN());
}

TEST(CloudFromProto, DecompressesBothEncodings) {
  std::vector<float> numbers(3 * 300'000);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i % 977);
  v1::Cloud message = float_cloud(numbers);
  message.set_xyz(compressed(message.xyz()));
  message.set_zstd(true);
  const PointCloud cloud = decode(message, 300'000);
  ASSERT_EQ(cloud.size(), 300'000U);
  EXPECT_EQ(std::memcmp(cloud.points.data(), numbers.data(), numbers.size() * 4), 0);

  message.set_encoding(v1::POINT_ENCODING_INT16);
  message.set_scale_m(0.01);
  message.set_points(2);
  message.set_xyz(compressed(raw<std::int16_t>({1, 2, 3, 4, 5, 6})));
  EXPECT_NEAR(decode(message).points.at(1).z(), 0.06, 1e-6);
}

TEST(CloudFromProto, KeepsShapeViewpointAndOrigin) {
  v1::Cloud message = float_cloud(std::vector<float>(18, 1.0F));
  message.set_width(3);
  message.set_height(2);
  message.mutable_viewpoint()->set_z(1.5);
  message.mutable_origin_m()->set_x(4e5);
  const PointCloud cloud = decode(message);
  EXPECT_EQ(cloud.width, 3U);
  EXPECT_EQ(cloud.height, 2U);
  ASSERT_EQ(cloud.viewpoints.size(), 1U);
  EXPECT_EQ(cloud.viewpoints[0].z(), 1.5F);
  EXPECT_EQ(cloud.origin.x(), 4e5);
}

TEST(CloudFromProto, TakesItsPointsFromTheAllowance) {
  PointAllowance allowance{3};
  from_proto(float_cloud(std::vector<float>(6, 1.0F)), allowance, "clouds[0]");
  EXPECT_EQ(allowance.points, 1U);
  try {
    from_proto(float_cloud(std::vector<float>(6, 1.0F)), allowance, "clouds[1]");
    FAIL() << "more points than allowed were taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
    EXPECT_EQ(error.field(), "clouds[1].points");
  }
}

TEST(CloudFromProto, RefusesACloudThatCannotBe) {
  const v1::Cloud good = float_cloud({1, 2, 3, 4, 5, 6});
  struct Case {
    const char* name;
    const char* field;
    std::function<void(v1::Cloud&)> spoil;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Case> cases = {
      {"no encoding", "clouds[0].encoding", [](auto& c) { c.clear_encoding(); }},
      {"unknown encoding",
       "clouds[0].encoding",
       [](auto& c) { c.set_encoding(v1::PointEncoding(9)); }},
      {"broken point", "clouds[0].xyz", [](auto& c) { c.mutable_xyz()->pop_back(); }},
      {"empty", "clouds[0].points", [](auto& c) { c.clear_xyz(), c.clear_points(); }},
      {"lying count", "clouds[0].points", [](auto& c) { c.set_points(1'000'000'000'000); }},
      {"shape", "clouds[0].width", [](auto& c) { c.set_width(2), c.set_height(2); }},
      {"shape that overflows",
       "clouds[0].width",
       [](auto& c) { c.set_width(1U << 31U), c.set_height(1U << 31U); }},
      {"viewpoint", "clouds[0].viewpoint", [&](auto& c) { c.mutable_viewpoint()->set_x(nan); }},
      {"origin", "clouds[0].origin_m", [&](auto& c) { c.mutable_origin_m()->set_x(1e300); }},
      {"no scale",
       "clouds[0].scale_m",
       [](auto& c) { c.set_encoding(v1::POINT_ENCODING_INT16), c.clear_points(); }},
      {"no zstd frame", "clouds[0].xyz", [](auto& c) { c.set_zstd(true); }},
  };
  for (const Case& test : cases) {
    v1::Cloud cloud = good;
    test.spoil(cloud);
    const Error error = refusal(cloud);
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << test.name;
    EXPECT_EQ(error.field(), test.field) << test.name;
  }
}

TEST(CloudFromProto, RefusesCompressedPointsThatAreNotWhatIsAnnounced) {
  v1::Cloud cloud = float_cloud({1, 2, 3, 4, 5, 6});
  const std::string packed = compressed(cloud.xyz());
  cloud.set_zstd(true);

  cloud.set_xyz(packed.substr(0, packed.size() - 3));
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("zstd frame"));
  cloud.set_xyz(packed + "x");
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("after the zstd frame"));
  cloud.set_xyz(packed);
  cloud.set_points(1);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("more than"));
  cloud.set_points(3);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("less than"));
  cloud.set_points(0);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("no points"));
  cloud.set_points(1'000'000'000'000);
  EXPECT_EQ(refusal(cloud).code(), ErrorCode::kResourceExhausted);
}

// A frame whose writer did not know the size of what is inside.
std::string compressed_stream(const std::string& bytes, int window_log = 0) {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  if (window_log > 0) ZSTD_CCtx_setParameter(context, ZSTD_c_windowLog, window_log);
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer result{out.data(), out.size(), 0};
  ZSTD_compressStream2(context, &result, &in, ZSTD_e_flush);  // with the end unknown yet
  ZSTD_compressStream2(context, &result, &in, ZSTD_e_end);
  ZSTD_freeCCtx(context);
  out.resize(result.pos);
  return out;
}

TEST(CloudFromProto, TakesAFrameThatDoesNotSayItsSize) {
  v1::Cloud cloud = float_cloud({1, 2, 3, 4, 5, 6});
  cloud.set_xyz(compressed_stream(cloud.xyz()));
  cloud.set_zstd(true);
  EXPECT_EQ(decode(cloud).size(), 2U);
  cloud.set_points(1);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("more than the 1 points"));
  cloud.set_points(3);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("12 bytes less"));
}

// A window is memory too, and a few bytes of header may ask for 2 GB of it.
TEST(CloudFromProto, RefusesAWindowOverTheLimitAndNamesIt) {
  v1::Cloud cloud;
  cloud.set_encoding(v1::POINT_ENCODING_FLOAT32);
  cloud.set_zstd(true);
  cloud.set_points(100);
  cloud.set_xyz(compressed_stream(std::string(1200, '\1'), kMaxZstdWindowLog + 1));
  const Error error = refusal(cloud);
  EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
  EXPECT_THAT(error.what(), HasSubstr("8388608"));
  cloud.set_xyz(compressed_stream(std::string(1200, '\1'), kMaxZstdWindowLog));
  EXPECT_EQ(decode(cloud).size(), 100U);
}

TEST(CloudFromProto, TakesTheBytesOfItsPointsFromTheMemoryBudget) {
  MemoryBudget memory(100);
  v1::Cloud packed = float_cloud(std::vector<float>(12, 1.0F));
  packed.set_xyz(compressed(packed.xyz()));
  packed.set_zstd(true);
  {
    PointAllowance allowance{1000, &memory};
    from_proto(packed, allowance, "clouds[0]");
    EXPECT_EQ(memory.left(), 52U) << "4 points of 12 bytes";
    from_proto(float_cloud(std::vector<float>(12, 1.0F)), allowance, "clouds[1]");
    EXPECT_EQ(memory.left(), 4U);
    try {
      from_proto(packed, allowance, "clouds[2]");
      FAIL() << "more memory than there is was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
      EXPECT_THAT(error.what(), HasSubstr("4 left of its limit of 100"));
    }
  }
  EXPECT_EQ(memory.left(), 100U);
}

TEST(CloudFromProto, StopsADecompressionBombAtTheAnnouncedSize) {
  v1::Cloud cloud;
  cloud.set_encoding(v1::POINT_ENCODING_FLOAT32);
  cloud.set_zstd(true);
  cloud.set_points(100);
  cloud.set_xyz(compressed(std::string(std::size_t{200} * 1024 * 1024, '\0')));
  ASSERT_LT(cloud.xyz().size(), 100'000U);
  EXPECT_THAT(refusal(cloud).what(), HasSubstr("more than the 100 points"));
}

TEST(CloudFromProto, ThrowsNothingButErrorsForMutatedMessages) {
  Random random(11);
  std::vector<float> numbers(300);
  for (float& number : numbers) number = static_cast<float>(random.uniform(-5, 5));
  v1::Cloud plain = float_cloud(numbers);
  plain.mutable_viewpoint()->set_x(1);
  plain.set_width(10);
  plain.set_height(10);
  v1::Cloud packed = plain;
  packed.set_xyz(compressed(plain.xyz()));
  packed.set_zstd(true);
  int taken = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes = (round % 2 == 0 ? plain : packed).SerializeAsString();
    for (std::uint64_t edits = random.below(3) + 1; edits > 0; --edits) {
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    }
    v1::Cloud cloud;
    if (!cloud.ParseFromString(bytes)) continue;
    try {
      const PointCloud result = decode(cloud);
      ASSERT_LE(result.size(), 1000U);
      ++taken;
    } catch (const Error& error) {
      ASSERT_TRUE(error.code() == ErrorCode::kInvalidArgument ||
                  error.code() == ErrorCode::kResourceExhausted)
          << error.what();
    }
  }
  EXPECT_GT(taken, 100);
}

}  // namespace
}  // namespace landmarkdb
