#include "client/read_points.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"
#include "engine/types/feature_names.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{32} << 20U;
constexpr std::size_t kMaxPoints = 100'000;  // the server's limit

class PointsReader {
 public:
  PointsReader(const std::string& name, RecognizeInput& input) : name_(name), input_(input) {}

  void read(const Json& json) {
    if (!json.is_object() || !json.contains("points") || !json["points"].is_array()) {
      refuse("has no list \"points\", want {\"points\": [{\"type\", \"uv\"}, ...]}");
    }
    const Json& points = json["points"];
    if (points.size() > kMaxPoints) {
      refuse(std::to_string(points.size()) + " points, want at most " + std::to_string(kMaxPoints));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      read_point(points[i], "point " + std::to_string(i));
    }
    if (json.contains("links")) read_links(json["links"]);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::kInvalidArgument, name_ + ": " + what);
  }

  double number(const Json& json, const std::string& what) const {
    if (!json.is_number() || !std::isfinite(json.get<double>())) {
      refuse(what + " has " + in_quotes(json.dump()) + ", want finite numbers");
    }
    return json.get<double>();
  }

  void read_point(const Json& json, const std::string& what) {
    if (!json.is_object()) refuse(what + " is a " + json.type_name() + ", want an object");
    ImagePoint point;
    if (json.contains("type")) point.type = type_of(json["type"], what);
    if (!json.contains("uv") || !json["uv"].is_array() || json["uv"].size() != 2) {
      refuse(what + " has no \"uv\" of 2 numbers");
    }
    point.uv = {number(json["uv"][0], what), number(json["uv"][1], what)};
    if (json.contains("directions")) {
      if (!json["directions"].is_array()) refuse(what + ": \"directions\" is no list");
      for (const Json& direction : json["directions"]) {
        point.directions_rad.push_back(number(direction, what));
      }
    }
    input_.points.push_back(std::move(point));
  }

  FeatureType type_of(const Json& json, const std::string& what) const {
    if (json.is_string()) {
      if (const auto type = feature_type_from_name(json.get<std::string>())) return *type;
    }
    refuse(what + " has the type " +
           (json.is_string() ? in_quotes(json.get<std::string>()) : json.dump()) +
           ", want vertex, conic_centre, centroid or inflexion");
  }

  void read_links(const Json& json) {
    if (!json.is_array()) refuse("\"links\" is no list");
    for (std::size_t i = 0; i < json.size(); ++i) {
      const auto index = [&](std::size_t k) {
        const Json& end = json[i][k];
        if (!end.is_number_unsigned() || end.get<std::uint64_t>() >= input_.points.size()) {
          refuse("link " + std::to_string(i) + " names point " + in_quotes(end.dump()) +
                 ", but there are " + std::to_string(input_.points.size()));
        }
        return end.get<std::uint32_t>();
      };
      if (!json[i].is_array() || json[i].size() != 2) {
        refuse("link " + std::to_string(i) + " is no pair of points");
      }
      input_.links.push_back({index(0), index(1)});
    }
  }

  const std::string& name_;
  RecognizeInput& input_;
};

}  // namespace

void parse_points(std::string_view text, const std::string& name, RecognizeInput& input) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& error) {
    throw Error(ErrorCode::kInvalidArgument, name + ": is not valid JSON: " + error.what());
  }
  take_points(json, name, input);
}

void take_points(const Json& json, const std::string& name, RecognizeInput& input) {
  PointsReader(name, input).read(json);
}

void read_points(const std::filesystem::path& path, RecognizeInput& input) {
  const FileBytes file = read_whole_file(path, kMaxFileBytes);
  const auto span = file.span();
  parse_points({reinterpret_cast<const char*>(span.data()), span.size()}, path.string(), input);
}

}  // namespace landmarkdb::client
