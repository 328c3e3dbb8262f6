#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "engine/base/error.hpp"
#include "engine/geometry/camera.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLongestFile = 256 * 1024;  // a camera file has about 1 kB
constexpr int kDeepest = 16;                      // of nested lists and maps
constexpr double kLargestImage_px = 65'535.0;

[[noreturn]] void refuse(std::string_view name, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, std::string(name) + ": " + what);
}

// Finds a value of the file by any of its usual names.
class CameraFile {
 public:
  CameraFile(YAML::Node root, std::string_view name) : root_(std::move(root)), name_(name) {}

  YAML::Node find(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      if (const YAML::Node node = root_[key]) return node;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  }

  double number(const YAML::Node& node, const std::string& key) const {
    const std::string text = node.IsScalar() ? node.Scalar() : std::string("no number");
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(begin, end, value);
    constexpr std::size_t kShown = 40;
    if (error != std::errc() || stopped != end || !std::isfinite(value)) {
      refuse(name_, key + " is \"" + text.substr(0, kShown) + "\", want a finite number");
    }
    return value;
  }

  double need(std::initializer_list<const char*> keys) const {
    const YAML::Node node = find(keys);
    if (!node) refuse(name_, std::string("has no ") + *keys.begin());
    return number(node, *keys.begin());
  }

  // The numbers of a list, of nested lists, or of an OpenCV matrix {rows, cols, data}.
  std::vector<double> numbers(const YAML::Node& node, const std::string& key) const {
    constexpr std::size_t kMost = 64;  // of any list in a camera file
    const YAML::Node data = node.IsMap() ? node["data"] : node;
    if (!data || !data.IsSequence() || data.size() > kMost) {
      refuse(name_, key + " is no list of numbers, nor {rows, cols, data}");
    }
    std::vector<double> values;
    for (const YAML::Node& item : data) {
      if (!item.IsSequence()) {
        values.push_back(number(item, key));
        continue;
      }
      if (item.size() > kMost) refuse(name_, key + " is no list of numbers");
      for (const YAML::Node& inner : item) values.push_back(number(inner, key));
    }
    if (node.IsMap() && node["rows"] && node["cols"]) {
      const double rows = number(node["rows"], key + " rows");
      const double cols = number(node["cols"], key + " cols");
      if (rows * cols != static_cast<double>(values.size())) {
        refuse(name_,
               key + " has " + std::to_string(values.size()) + " numbers, but rows times cols is " +
                   std::to_string(rows * cols));
      }
    }
    return values;
  }

  std::string_view name() const { return name_; }

 private:
  YAML::Node root_;
  std::string_view name_;
};

std::uint32_t take_size(const CameraFile& file, std::initializer_list<const char*> keys) {
  const double value = file.need(keys);
  if (!(value >= 1.0 && value <= kLargestImage_px && value == std::floor(value))) {
    std::ostringstream message;
    message << *keys.begin() << " is " << value << ", want a whole number of pixels from 1 to "
            << kLargestImage_px;
    refuse(file.name(), message.str());
  }
  return static_cast<std::uint32_t>(value);
}

void take_matrix(const CameraFile& file, Camera& camera) {
  const YAML::Node node = file.find({"camera_matrix", "K", "k"});
  if (!node) {
    camera.fx = file.need({"fx"});
    camera.fy = file.need({"fy"});
    camera.cx = file.need({"cx"});
    camera.cy = file.need({"cy"});
    return;
  }
  const std::vector<double> K = file.numbers(node, "camera_matrix");
  if (K.size() != 9) {
    refuse(file.name(),
           "camera_matrix has " + std::to_string(K.size()) + " numbers, want 9, row by row");
  }
  if (K[1] != 0.0 || K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0) {
    refuse(file.name(), "camera_matrix is not fx 0 cx, 0 fy cy, 0 0 1 (row by row)");
  }
  camera.fx = K[0];
  camera.cx = K[2];
  camera.fy = K[4];
  camera.cy = K[5];
}

void take_distortion(const CameraFile& file, Camera& camera) {
  const YAML::Node model = file.find({"distortion_model"});
  if (model && model.IsScalar()) {
    const std::string& kind = model.Scalar();
    if (kind != "plumb_bob" && kind != "none" && !kind.empty()) {
      refuse(
          file.name(),
          "distortion_model is \"" + kind.substr(0, 40) + "\", want plumb_bob (undistort first)");
    }
  }
  const YAML::Node node = file.find({"distortion_coefficients", "dist", "D", "d"});
  if (!node || node.IsNull()) return;
  const std::vector<double> values = file.numbers(node, "distortion_coefficients");
  for (std::size_t i = camera.dist.size(); i < values.size(); ++i) {
    if (values[i] == 0.0) continue;
    refuse(file.name(),
           "distortion_coefficients has " + std::to_string(values.size()) +
               " numbers, want at most five: k1 k2 p1 p2 k3");
  }
  std::copy_n(values.begin(), std::min(values.size(), camera.dist.size()), camera.dist.begin());
}

void check_camera(const Camera& camera, std::string_view name) {
  // A principal point further out than this belongs to another unit, not to a lens.
  constexpr double kOutside = 10.0;
  const double size = std::max(camera.width, camera.height);
  if (!(camera.fx > 0.0) || camera.fy == 0.0 || !std::isfinite(camera.fy)) {
    std::ostringstream message;
    message << "focal lengths are " << camera.fx << " and " << camera.fy
            << " pixels, want fx positive and fy positive (negative where rows run upwards)";
    refuse(name, message.str());
  }
  if (std::abs(camera.cx) > kOutside * size || std::abs(camera.cy) > kOutside * size) {
    std::ostringstream message;
    message << "the principal point is " << camera.cx << ", " << camera.cy << ", far outside the "
            << camera.width << " x " << camera.height << " image";
    refuse(name, message.str());
  }
}

// JSON is YAML once its tabs are gone; reading and writing it again takes them out, and the depth
// is bounded before anything recurses over it.
std::string json_as_yaml(const std::string& text) {
  const auto bounded = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kDeepest) throw std::invalid_argument("nested too deeply");
    return true;
  };
  return nlohmann::json::parse(text, bounded).dump();
}

// OpenCV starts its files with "%YAML:1.0", which is no YAML directive.
std::string without_opencv_header(const std::string& text) {
  if (!text.starts_with("%YAML")) return text;
  const std::size_t end = text.find('\n');
  return end == std::string::npos ? std::string() : text.substr(end + 1);
}

YAML::Node load(const std::string& text, std::string_view name) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) refuse(name, "is empty, want a camera file");
  try {
    YAML::Node root = YAML::Load(text[first] == '{' ? json_as_yaml(text)
                                                    : without_opencv_header(text.substr(first)));
    if (!root.IsMap()) refuse(name, "is no camera file: want keys and values (YAML or JSON)");
    return root;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    refuse(name, std::string("is neither YAML nor JSON: ") + error.what());
  }
}

}  // namespace

Camera parse_camera(const std::string& text, std::string_view name) {
  if (text.size() > kLongestFile) {
    refuse(name,
           "has " + std::to_string(text.size()) + " bytes, want at most " +
               std::to_string(kLongestFile) + " for a camera file");
  }
  const CameraFile file(load(text, name), name);
  Camera camera;
  try {
    camera.width = take_size(file, {"width", "image_width"});
    camera.height = take_size(file, {"height", "image_height"});
    take_matrix(file, camera);
    take_distortion(file, camera);
    if (const YAML::Node scale = file.find({"depth_scale"})) {
      camera.depth_scale = file.number(scale, "depth_scale");
      if (!(camera.depth_scale > 0.0)) {
        refuse(name, "depth_scale is not positive, want raw units per metre (1000 for mm)");
      }
    }
  } catch (const YAML::Exception& error) {
    refuse(name, std::string("cannot be understood: ") + error.what());
  }
  check_camera(camera, name);
  return camera;
}

Camera read_camera(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    refuse(name, "is not a regular file");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(name, std::string("cannot be read: ") + std::strerror(errno));
  // One byte more than allowed is enough to see that a file is too long.
  std::string text(kLongestFile + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_camera(text, name);
}

}  // namespace landmarkdb
