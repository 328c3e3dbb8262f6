#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/camera.hpp"

namespace landmarkdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kRos = R"(image_width: 640
image_height: 480
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [525.5, 0, 319.5, 0, 526, 239.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.1, -0.2, 0.001, -0.002, 0.3]
depth_scale: 5000
)";

constexpr const char* kOpencv = R"(%YAML:1.0
---
width: 640
height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.2550000000000000e+02, 0., 3.1950000000000000e+02, 0.,
       526., 239.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0.1, -0.2, 0.001, -0.002, 0.3 ]
depth_scale: 5000.
)";

constexpr const char* kJson =
    "{\n\t\"width\": 640, \"height\": 480,\n\t\"fx\": 525.5, \"fy\": 526, \"cx\": 319.5,"
    " \"cy\": 239.5,\n\t\"dist\": [0.1, -0.2, 0.001, -0.002, 0.3], \"depth_scale\": 5000,"
    " \"note\": \"a: {b\"}";

std::string with_replaced(std::string file, const std::string& what, const std::string& by) {
  const std::size_t at = file.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return file.replace(at, what.size(), by);
}

TEST(ReadCamera, ReadsRosOpencvAndJsonAlike) {
  for (const char* text : {kRos, kOpencv, kJson}) {
    const Camera camera = parse_camera(text, "camera");
    EXPECT_EQ(camera.width, 640U);
    EXPECT_EQ(camera.height, 480U);
    EXPECT_EQ(camera.fx, 525.5);
    EXPECT_EQ(camera.fy, 526.0);
    EXPECT_EQ(camera.cx, 319.5);
    EXPECT_EQ(camera.cy, 239.5);
    EXPECT_EQ(camera.dist, (std::array{0.1, -0.2, 0.001, -0.002, 0.3}));
    EXPECT_EQ(camera.depth_scale, 5000.0);
  }
}

TEST(ReadCamera, LeavesOutDistortionAndScaleThatAreNotGiven) {
  const Camera camera = parse_camera(
      R"({"width": 4, "height": 3, "fx": 1, "fy": 1, "cx": 1.5, "cy": 1})", "camera.json");
  EXPECT_EQ(camera.dist, (std::array{0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(camera.depth_scale, 0.0);
}

TEST(ReadCamera, TakesNestedRowsAndFourCoefficients) {
  const Camera camera = parse_camera(
      "width: 4\nheight: 3\ncamera_matrix: [[2, 0, 1.5], [0, 2, 1], [0, 0, 1]]\n"
      "distortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n",
      "camera.yaml");
  EXPECT_EQ(camera.fx, 2.0);
  EXPECT_EQ(camera.dist, (std::array{0.1, 0.2, 0.3, 0.4, 0.0}));
}

TEST(ReadCamera, NamesTheFileTheKeyAndWhatWasWanted) {
  const auto message = [](const std::string& what, const std::string& by) {
    try {
      parse_camera(with_replaced(kRos, what, by), "cam.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message("image_width: 640", "image_widht: 640"),
              AllOf(HasSubstr("cam.yaml"), HasSubstr("has no width")));
  EXPECT_THAT(message("640", "-640"), HasSubstr("width is -640"));
  EXPECT_THAT(message("640", "1e12"), HasSubstr("width is 1e+12"));
  EXPECT_THAT(message("640", "64.5"), HasSubstr("whole number"));
  EXPECT_THAT(message("640", "wide"), HasSubstr("\"wide\""));
  EXPECT_THAT(message("525.5", ".nan"), HasSubstr("camera_matrix"));
  EXPECT_THAT(message("525.5", "nan"), HasSubstr("finite"));
  EXPECT_THAT(message("525.5", "-525.5"), HasSubstr("focal lengths are -525.5"));
  EXPECT_THAT(message("[525.5, 0,", "[525.5, 3,"), HasSubstr("fx 0 cx"));
  EXPECT_THAT(message("319.5", "319500"), HasSubstr("principal point"));
  EXPECT_THAT(message("rows: 3", "rows: 4"), HasSubstr("rows times cols"));
  EXPECT_THAT(message("plumb_bob", "equidistant"), HasSubstr("\"equidistant\""));
  EXPECT_THAT(message("cols: 5\n  data: [0.1", "cols: 6\n  data: [1, 0.1"),
              HasSubstr("at most five"));
  EXPECT_THAT(message("5000", "0"), HasSubstr("depth_scale"));
}

TEST(ReadCamera, RefusesWhatIsNoCameraFile) {
  for (const std::string& text : {std::string(),
                                  std::string("  \n"),
                                  std::string("just words"),
                                  std::string("[1, 2, 3]"),
                                  std::string("{\"width\": 640"),
                                  std::string("a: [b"),
                                  std::string("%YAML:1.0"),
                                  std::string("width: [1, 2]\nheight: {a: b}")}) {
    EXPECT_THROW(parse_camera(text, "camera"), Error) << text;
  }
}

TEST(ReadCamera, IsBoundedAgainstFilesMadeToHurt) {
  EXPECT_THAT([] { parse_camera(std::string(1 << 20, 'a'), "camera"); },
              ThrowsMessage<Error>(HasSubstr("bytes, want at most")));
  for (const char* opening : {"[", "{\"a\":", "{a: ", "- ", "? "}) {
    std::string nested = std::string(opening).front() == '{' ? "" : "a: ";
    while (nested.size() < 100'000) nested += opening;
    EXPECT_THROW(parse_camera(nested, "camera"), Error) << opening;
  }
  std::ostringstream bomb;
  bomb << "a0: &a0 [1, 1]\n";
  for (int i = 1; i < 60; ++i) {
    bomb << 'a' << i << ": &a" << i << " [*a" << i - 1 << ", *a" << i - 1 << "]\n";
  }
  bomb << "camera_matrix: *a59\nwidth: 4\nheight: 3\n";
  EXPECT_THROW(parse_camera(bomb.str(), "camera"), Error);
  EXPECT_THROW(parse_camera("width: 4\nheight: 3\ncamera_matrix: &a [*a, *a]\n", "camera"), Error);
}

TEST(ReadCamera, EndsInACameraOrAnErrorWhateverHappenedToTheFile) {
  Random random(1);
  for (const std::string whole : {kRos, kOpencv, kJson}) {
    for (int round = 0; round < 400; ++round) {
      std::string file = whole;
      if (round % 3 == 0) {
        file.resize(random.below(file.size()));
      } else {
        file[random.below(file.size())] = static_cast<char>(random.below(256));
      }
      try {
        const Camera camera = parse_camera(file, "camera");
        EXPECT_GT(camera.fx, 0.0);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      }
    }
  }
}

TEST(ReadCamera, ReadsFromDiskAndSaysWhatIsMissing) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / "read_camera_test.yaml";
  std::ofstream(path) << kRos;
  EXPECT_EQ(read_camera(path).width, 640U);
  std::filesystem::remove(path);
  try {
    read_camera(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
  }
  EXPECT_THROW(read_camera("/dev/zero"), Error);
}

}  // namespace
}  // namespace landmarkdb
