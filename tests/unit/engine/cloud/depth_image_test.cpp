#include "engine/cloud/depth_image.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <png.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::uint32_t kWidth = 8;
constexpr std::uint32_t kHeight = 6;

Camera camera() {
  Camera c;
  c.width = kWidth;
  c.height = kHeight;
  c.fx = 10.0;
  c.fy = 12.0;
  c.cx = 3.5;
  c.cy = 2.5;
  c.depth_scale = 1000.0;
  return c;
}

void append_bytes(png_structp png, png_bytep data, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

std::string make_png(int bits, int colour_type, std::uint16_t depth) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, append_bytes, nullptr);
  png_set_IHDR(png, info, kWidth, kHeight, bits, colour_type, PNG_INTERLACE_NONE, 0, 0);
  png_write_info(png, info);
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    std::vector<png_byte> row(kWidth * 8, 0);
    for (std::uint32_t u = 0; u < kWidth && bits == 16; ++u) {
      const std::uint16_t value = u == 0 ? 0 : u == 1 ? 65'535 : depth;
      row[2 * u] = static_cast<png_byte>(value >> 8);
      row[2 * u + 1] = static_cast<png_byte>(value & 255);
    }
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return file;
}

std::string depth_png() { return make_png(16, PNG_COLOR_TYPE_GRAY, 2000); }

PointCloud parse_depth(const std::string& file, const Camera& with) {
  return parse_depth_image(testing::as_bytes(file), "depth.png", with);
}

TEST(DepthImage, BecomesAnOrganisedCloudInTheCameraFrame) {
  const PointCloud cloud = parse_depth(depth_png(), camera());
  ASSERT_EQ(cloud.size(), std::size_t{kWidth} * kHeight);
  EXPECT_EQ(cloud.width, kWidth);
  EXPECT_EQ(cloud.height, kHeight);
  ASSERT_EQ(cloud.viewpoints.size(), 1U);
  EXPECT_TRUE(cloud.viewpoints[0].isZero());
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    EXPECT_TRUE(std::isnan(cloud.points[v * kWidth].z())) << "no depth";
    EXPECT_TRUE(std::isnan(cloud.points[v * kWidth + 1].z())) << "saturated";
    const Eigen::Vector3f p = cloud.points[v * kWidth + 5];
    EXPECT_NEAR(p.x(), 2.0 * (5 - 3.5) / 10.0, 1e-6);
    EXPECT_NEAR(p.y(), 2.0 * (v - 2.5) / 12.0, 1e-6);
    EXPECT_NEAR(p.z(), 2.0, 1e-6);
  }
}

TEST(DepthImage, UndoesTheLensDistortion) {
  Camera bent = camera();
  bent.dist = {-0.2, 0.05, 0.001, -0.002, 0.01};
  const PointCloud cloud = parse_depth(depth_png(), bent);
  const Eigen::Vector3d p = cloud.points[3 * kWidth + 6].cast<double>();
  const Eigen::Vector2d uv = distort(bent, (p.head<2>() / p.z()));
  EXPECT_NEAR(uv.x(), 6.0, 1e-5);
  EXPECT_NEAR(uv.y(), 3.0, 1e-5);
}

TEST(DepthImage, RefusesASizeThatIsNotTheCameras) {
  Camera other = camera();
  other.width = 640;
  EXPECT_THAT([&] { parse_depth(depth_png(), other); },
              ThrowsMessage<Error>(HasSubstr("8 x 6 pixels, but the camera file is for 640 x 6")));
}

TEST(DepthImage, RefusesACameraWithoutADepthScale) {
  Camera other = camera();
  other.depth_scale = 0.0;
  EXPECT_THAT([&] { parse_depth(depth_png(), other); },
              ThrowsMessage<Error>(HasSubstr("depth_scale")));
}

TEST(DepthImage, RefusesOtherPictures) {
  EXPECT_THAT([&] { parse_depth(make_png(8, PNG_COLOR_TYPE_GRAY, 0), camera()); },
              ThrowsMessage<Error>(HasSubstr("8 bits grey")));
  EXPECT_THAT([&] { parse_depth(make_png(8, PNG_COLOR_TYPE_RGB, 0), camera()); },
              ThrowsMessage<Error>(HasSubstr("in colour")));
  EXPECT_THAT([&] { parse_depth("no picture", camera()); },
              ThrowsMessage<Error>(HasSubstr("no PNG")));
}

TEST(DepthImage, EndsInACloudOrAnErrorWhateverHappenedToTheFile) {
  const std::string whole = depth_png();
  Random random(1);
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string file = whole;
    if (round % 2 == 0) {
      file.resize(random.below(file.size()));
    } else {
      file[random.below(file.size())] = static_cast<char>(random.below(256));
    }
    try {
      parse_depth(file, camera());
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace landmarkdb
