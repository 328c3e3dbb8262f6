#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/model_draft.hpp"
#include "engine/types/feature_names.hpp"

namespace landmarkdb {
namespace {

using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;

std::optional<Units> units_from(const std::string& text) {
  if (text == "m") return Units::kMetres;
  if (text == "mm") return Units::kMillimetres;
  if (text == "cm") return Units::kCentimetres;
  if (text == "inch") return Units::kInches;
  return std::nullopt;
}

class JsonModelReader {
 public:
  JsonModelReader(const Input& input, const Json& json) : input_(input), json_(json) {}

  ModelDraft read(const ReadModelOptions& options) {
    if (!json_.is_object()) refuse(input_, "is no JSON object, want {\"points\": [...], ...}");
    read_name();
    scale_ = draft_.model.unit_scale = metres_per(read_units(options));
    read_circles();
    read_points();
    read_edges();
    read_faces();
    read_symmetries();
    return std::move(draft_);
  }

 private:
  static std::string kind(const Json& json) { return std::string(json.type_name()); }

  // The list under `key`; an empty one where there is none.
  const Json& list(const char* key, std::size_t most) const {
    static const Json none = Json::array();
    const auto at = json_.find(key);
    if (at == json_.end() || at->is_null()) return none;
    if (!at->is_array()) {
      refuse(input_, "\"" + std::string(key) + "\" is a " + kind(*at) + ", want a list");
    }
    require_at_most(input_, at->size(), most, key);
    return *at;
  }

  void read_name() {
    const auto name = json_.find("name");
    if (name == json_.end() || name->is_null()) return;
    if (!name->is_string()) refuse(input_, "\"name\" is a " + kind(*name) + ", want text");
    draft_.model.name = name->get<std::string>();
  }

  Units read_units(const ReadModelOptions& options) const {
    const auto units = json_.find("units");
    if (units == json_.end() || units->is_null()) return options.units.value_or(Units::kMetres);
    if (!units->is_string()) refuse(input_, "\"units\" is a " + kind(*units) + ", want text");
    const auto said = units_from(units->get<std::string>());
    if (!said) {
      refuse(input_,
             "\"units\" is " + in_quotes(units->get<std::string>()) +
                 ", want \"m\", \"mm\", \"cm\" or \"inch\"");
    }
    if (options.units && *options.units != *said) {
      refuse(input_,
             "says its units are " + in_quotes(units->get<std::string>()) +
                 ", but others were asked for: leave one of them out");
    }
    return *said;
  }

  double number(const Json& json, const std::string& what) const {
    if (!json.is_number()) refuse(input_, what + " has a " + kind(json) + ", want numbers");
    return json.get<double>();
  }

  Eigen::Vector3d vector(const Json& json, const std::string& what, double scale) const {
    if (!json.is_array() || json.size() != 3) {
      refuse(input_,
             what + " is " +
                 (json.is_array() ? std::to_string(json.size()) + " numbers" : kind(json)) +
                 ", want 3 numbers");
    }
    Eigen::Vector3d result;
    for (std::size_t i = 0; i < 3; ++i) {
      result[static_cast<Eigen::Index>(i)] = number(json[i], what) * scale;
      require_coordinate(input_, result[static_cast<Eigen::Index>(i)], what);
    }
    return result;
  }

  Eigen::Vector3d direction(const Json& json, const std::string& what) const {
    const Eigen::Vector3d v = vector(json, what, 1.0);
    constexpr double kShortest = 1e-9;
    if (v.norm() < kShortest) refuse(input_, what + " has no length, want a direction");
    return v.normalized();
  }

  const Json& member(const Json& json, const char* key, const std::string& what) const {
    const auto at = json.find(key);
    if (at == json.end()) refuse(input_, what + " has no \"" + std::string(key) + "\"");
    return *at;
  }

  void read_points() {
    const Json& points = list("points", kMaxModelPoints);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::string what = "point " + std::to_string(i);
      const Json& json = points[i];
      ModelFeature feature;
      if (json.is_object()) {
        feature.xyz = vector(member(json, "xyz", what), what, scale_);
        if (json.contains("type")) feature.type = type_of(json["type"], what);
        if (json.contains("normal") && !json["normal"].is_null()) {
          feature.normal = direction(json["normal"], what + "'s normal");
        }
      } else {
        feature.xyz = vector(json, what, scale_);
      }
      draft_.model.points.push_back(std::move(feature));
    }
  }

  FeatureType type_of(const Json& json, const std::string& what) const {
    const std::string text = json.is_string() ? json.get<std::string>() : kind(json);
    const auto type = feature_type_from_name(text);
    if (!type) {
      refuse(input_,
             what + " has the type " + in_quotes(text) +
                 ", want vertex, conic_centre, centroid or inflexion");
    }
    return *type;
  }

  std::uint32_t index(const Json& json, const std::string& what) const {
    const std::size_t count = draft_.model.points.size();
    if (!json.is_number_integer() || json.get<std::int64_t>() < 0 ||
        json.get<std::uint64_t>() >= count) {
      refuse(input_,
             what + " names point " + in_quotes(json.dump()) + ", but there are " +
                 std::to_string(count) + " (numbered from 0)");
    }
    return json.get<std::uint32_t>();
  }

  void read_edges() {
    const Json& edges = list("edges", kMaxModelEdges);
    draft_.edges_listed = !edges.empty();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const std::string what = "edge " + std::to_string(i);
      if (!edges[i].is_array() || edges[i].size() != 2)
        refuse(input_, what + " is no pair of points");
      const std::uint32_t a = index(edges[i][0], what);
      const std::uint32_t b = index(edges[i][1], what);
      if (a == b) refuse(input_, what + " joins point " + std::to_string(a) + " with itself");
      draft_.model.edges.push_back({a, b});
    }
  }

  void read_faces() {
    const Json& faces = list("faces", kMaxModelFaces);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const std::string what = "face " + std::to_string(i);
      if (!faces[i].is_array() || faces[i].size() < 3) {
        refuse(input_, what + " has fewer than 3 points, want 3 or more");
      }
      require_at_most(input_, faces[i].size(), 2 * kMaxModelPoints, "points in " + what);
      std::vector<std::uint32_t> face;
      for (const Json& corner : faces[i]) face.push_back(index(corner, what));
      draft_.model.faces.push_back(std::move(face));
    }
  }

  void read_circles() {
    const Json& circles = list("circles", kMaxModelCircles);
    for (std::size_t i = 0; i < circles.size(); ++i) {
      const std::string what = "circle " + std::to_string(i);
      if (!circles[i].is_object()) {
        refuse(input_, what + " is a " + kind(circles[i]) + ", want center, normal and radius");
      }
      ModelCircle circle;
      circle.center = vector(member(circles[i], "center", what), what + "'s center", scale_);
      circle.normal = direction(member(circles[i], "normal", what), what + "'s normal");
      circle.radius_m = number(member(circles[i], "radius", what), what + "'s radius") * scale_;
      require_coordinate(input_, circle.radius_m, what);
      if (circle.radius_m <= 0.0) {
        refuse(input_,
               what + " has the radius " + std::to_string(circle.radius_m) + " m, want above 0");
      }
      draft_.model.circles.push_back(circle);
    }
  }

  void read_symmetries() {
    const Json& symmetries = list("symmetries", kMaxModelSymmetries);
    draft_.symmetries_listed = json_.contains("symmetries") && !symmetries.empty();
    for (std::size_t i = 0; i < symmetries.size(); ++i) {
      const std::string what = "symmetry " + std::to_string(i);
      if (!symmetries[i].is_array() || symmetries[i].size() != 16) {
        refuse(input_, what + " is no list of 16 numbers (a 4x4 matrix, row by row)");
      }
      std::array<double, 16> numbers{};
      for (std::size_t k = 0; k < 16; ++k) numbers[k] = number(symmetries[i][k], what);
      for (const std::size_t k : {3U, 7U, 11U}) numbers[k] *= scale_;
      try {
        draft_.model.symmetries.push_back(from_row_major(numbers).matrix());
      } catch (const Error& error) {
        refuse(input_, what + " is no rigid motion: " + error.what());
      }
    }
  }

  const Input& input_;
  const Json& json_;
  double scale_ = 1.0;
  ModelDraft draft_;
};

// The depth at which JSON is refused: a model needs four levels, and the parser recurses.
constexpr int kDeepest = 16;

Ordered numbers_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

ModelDraft parse_model_json(const Input& input, const ReadModelOptions& options) {
  Json json;
  try {
    const auto guard = [](int depth, Json::parse_event_t, Json&) {
      if (depth > kDeepest) throw Error(ErrorCode::kInvalidArgument, "nested too deeply");
      return true;
    };
    json = Json::parse(input.text().begin(), input.text().end(), guard);
  } catch (const Json::exception& error) {
    refuse(input, std::string("is not valid JSON: ") + error.what());
  } catch (const Error& error) {
    refuse(input, error.what());
  }
  return JsonModelReader(input, json).read(options);
}

std::string model_to_json(const MonoModel& model) {
  Ordered json = {{"name", model.name}, {"units", "m"}};
  json["points"] = Ordered::array();
  for (const ModelFeature& p : model.points) {
    Ordered point = {{"xyz", numbers_of(p.xyz)}, {"type", feature_type_name(p.type)}};
    if (p.normal) point["normal"] = numbers_of(*p.normal);
    json["points"].push_back(std::move(point));
  }
  json["edges"] = model.edges;
  json["circles"] = Ordered::array();
  for (const ModelCircle& c : model.circles) {
    json["circles"].push_back({{"center", numbers_of(c.center)},
                               {"normal", numbers_of(c.normal)},
                               {"radius", c.radius_m}});
  }
  json["faces"] = model.faces;
  json["symmetries"] = Ordered::array();
  for (const Eigen::Matrix4d& T : model.symmetries) json["symmetries"].push_back(to_row_major(T));
  return json.dump(-1, ' ', false, Ordered::error_handler_t::replace);
}

}  // namespace landmarkdb
