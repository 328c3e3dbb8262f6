#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_lines.hpp"
#include "engine/mono/model_draft.hpp"

namespace landmarkdb {
namespace {

// ViSP's CAD text, version V1: counted lists of points, lines, faces by lines, faces by points,
// cylinders and circles, a record a line; '#' begins a comment. Each may end in settings
// (name=..., useLod=...), which say how a tracker draws it and are skipped.
class CaoReader {
 public:
  CaoReader(const Input& input, double metres_per_unit, const LoadPart& load)
      : input_(input), scale_(metres_per_unit), load_(load), lines_(input.text()) {}

  ModelDraft read() {
    read_version();
    if (!next_record()) refuse(input_, "ends before its points");
    while (rest_.starts_with("load")) {
      join_part();
      if (!next_record()) return finish();
    }
    pending_ = true;
    read_points();
    read_lines();
    read_line_faces();
    read_point_faces();
    read_cylinders();
    read_circles();
    return finish();
  }

 private:
  std::string where() const { return "line " + std::to_string(lines_.number()); }

  // The next line with something on it but a comment.
  bool next_record() {
    if (pending_) {
      pending_ = false;
      return true;
    }
    std::string_view line;
    while (lines_.next(line)) {
      input_.tick(lines_.number(), lines_.at());
      rest_ = line.substr(0, line.find('#'));
      std::string_view probe = rest_;
      if (take_word(probe).empty()) continue;
      while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
      return true;
    }
    return false;
  }

  void read_version() {
    if (!next_record()) refuse(input_, "has no text but comments, want \"V1\"");
    const std::string_view word = take_word(rest_);
    if (word != "V1") {
      refuse(input_, where() + ": " + in_quotes(word) + ", want the version \"V1\" first");
    }
  }

  // load("part.cao"): the part's points and all else come first.
  void join_part() {
    const std::size_t open = rest_.find('"');
    const std::size_t close = rest_.find('"', open + 1);
    if (open == std::string_view::npos || close == std::string_view::npos) {
      refuse(input_, where() + ": " + in_quotes(rest_) + ", want load(\"part.cao\")");
    }
    if (rest_.substr(close + 1).find('=') != std::string_view::npos) {
      refuse(input_, where() + ": a part loaded with a motion cannot be read; write it in place");
    }
    const std::string part(rest_.substr(open + 1, close - open - 1));
    if (!load_) {
      refuse(input_,
             where() + ": loads " + in_quotes(part) +
                 ", which is not followed here; join the parts into one file");
    }
    append(load_(part));
  }

  void append(ModelDraft part) {
    const auto first = static_cast<std::uint32_t>(points_.size());
    for (const ModelFeature& p : part.model.points) {
      points_.push_back(p.xyz);
      used_.push_back(true);
    }
    require_at_most(input_, points_.size(), kMaxCaoPoints, "points with those of its parts");
    for (const auto& [a, b] : part.model.edges) part_edges_.push_back({a + first, b + first});
    for (auto& face : part.model.faces) {
      for (std::uint32_t& corner : face) corner += first;
      draft_.model.faces.push_back(std::move(face));
    }
    for (const ModelCircle& circle : part.model.circles) draft_.model.circles.push_back(circle);
    first_own_ = points_.size();
  }

  // The count a list begins with; 0 past the end of the file, as old files leave lists out.
  std::size_t read_count(std::size_t most, std::string_view what) {
    if (!next_record()) return 0;
    const std::string_view word = take_word(rest_);
    const auto count = parse_count(word);
    if (!count) {
      refuse(input_, where() + ": " + in_quotes(word) + " is no count of " + std::string(what));
    }
    require_at_most(input_, *count, most, what);
    return *count;
  }

  void need_record(std::string_view what) {
    if (!next_record()) refuse(input_, "ends within its " + std::string(what) + " (cut off?)");
  }

  double number(std::string_view what) {
    const std::string_view word = take_word(rest_);
    const auto value = parse_number(word);
    if (!value) {
      refuse(input_,
             where() + ": " + (word.empty() ? "ends early" : in_quotes(word) + " is no number") +
                 ", want " + std::string(what));
    }
    return *value;
  }

  std::uint32_t index(std::size_t count, std::string_view what) {
    const std::string_view word = take_word(rest_);
    const auto value = parse_count(word);
    if (!value || *value >= count) {
      refuse(input_,
             where() + ": " + (word.empty() ? "ends early" : in_quotes(word)) + ", want " +
                 std::string(what) + " below " + std::to_string(count));
    }
    return static_cast<std::uint32_t>(*value);
  }

  // A point of this file, marked as a corner when `corner`.
  std::uint32_t point(bool corner) {
    const std::size_t own = points_.size() - first_own_;
    const auto at = static_cast<std::uint32_t>(first_own_ + index(own, "a point's number"));
    if (corner) used_[at] = true;
    return at;
  }

  void read_points() {
    const std::size_t count = read_count(kMaxCaoPoints, "points");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("points");
      Eigen::Vector3d xyz;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        xyz[axis] = number("a coordinate") * scale_;
        require_coordinate(input_, xyz[axis], where());
      }
      points_.push_back(xyz);
      used_.push_back(false);
    }
  }

  void read_lines() {
    const std::size_t count = read_count(kMaxModelEdges, "lines");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("lines");
      const std::uint32_t a = point(true);
      const std::uint32_t b = point(true);
      if (a == b) refuse(input_, where() + ": a line from a point to itself");
      cao_lines_.push_back({a, b});
    }
  }

  std::size_t corner_count() {
    constexpr std::size_t kMostCorners = 2 * kMaxModelPoints;
    const auto count = static_cast<std::size_t>(index(kMostCorners + 1, "a number of corners"));
    if (count < 3) refuse(input_, where() + ": a face of fewer than 3 corners");
    return count;
  }

  void read_line_faces() {
    const std::size_t count = read_count(kMaxModelFaces, "faces by lines");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("faces by lines");
      const std::size_t corners = corner_count();
      std::vector<std::array<std::uint32_t, 2>> sides;
      for (std::size_t k = 0; k < corners; ++k) {
        sides.push_back(cao_lines_[index(cao_lines_.size(), "a line's number")]);
      }
      draft_.model.faces.push_back(chain(sides));
    }
  }

  // The corners in the order in which the lines follow each other.
  std::vector<std::uint32_t> chain(const std::vector<std::array<std::uint32_t, 2>>& sides) const {
    std::vector<std::uint32_t> corners;
    const auto holds = [](const std::array<std::uint32_t, 2>& side, std::uint32_t p) {
      return side[0] == p || side[1] == p;
    };
    std::uint32_t at = holds(sides[1], sides[0][1]) ? sides[0][0] : sides[0][1];
    for (const auto& side : sides) {
      if (!holds(side, at)) refuse(input_, where() + ": the face's lines do not follow each other");
      corners.push_back(at);
      at = side[0] == at ? side[1] : side[0];
    }
    if (at != corners.front()) refuse(input_, where() + ": the face's lines do not close");
    return corners;
  }

  void read_point_faces() {
    const std::size_t count = read_count(kMaxModelFaces, "faces by points");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("faces by points");
      std::vector<std::uint32_t> face(corner_count());
      for (std::uint32_t& corner : face) corner = point(true);
      draft_.model.faces.push_back(std::move(face));
    }
  }

  double radius() {
    const double value = number("a radius") * scale_;
    require_coordinate(input_, value, where());
    if (value <= 0.0) refuse(input_, where() + ": a radius of " + std::to_string(value) + " m");
    return value;
  }

  // A cylinder is its two rims: what lies between is seen as silhouettes, which no point marks.
  void read_cylinders() {
    const std::size_t count = read_count(kMaxModelCircles, "cylinders");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("cylinders");
      const Eigen::Vector3d a = points_[point(false)];
      const Eigen::Vector3d b = points_[point(false)];
      const double r = radius();
      if ((b - a).norm() <= 0.0) refuse(input_, where() + ": a cylinder without a length");
      const Eigen::Vector3d axis = (b - a).normalized();
      draft_.model.circles.push_back({a, -axis, r});
      draft_.model.circles.push_back({b, axis, r});
    }
  }

  void read_circles() {
    const std::size_t count = read_count(kMaxModelCircles, "circles");
    for (std::size_t i = 0; i < count; ++i) {
      need_record("circles");
      const double r = radius();
      const Eigen::Vector3d center = points_[point(false)];
      const Eigen::Vector3d a = points_[point(false)] - center;
      const Eigen::Vector3d b = points_[point(false)] - center;
      constexpr double kLeastSine = 1e-6;
      const Eigen::Vector3d normal = a.cross(b);
      if (!(normal.norm() > kLeastSine * a.norm() * b.norm())) {
        refuse(input_, where() + ": the circle's three points lie on one line");
      }
      draft_.model.circles.push_back({center, normal.normalized(), r});
    }
    require_at_most(input_, draft_.model.circles.size(), kMaxModelCircles, "circles");
  }

  // Points that only place a cylinder or circle are no corners.
  ModelDraft finish() {
    MonoModel& model = draft_.model;
    model.unit_scale = scale_;
    model.edges = std::move(part_edges_);
    for (const auto& side : cao_lines_) model.edges.push_back(side);
    draft_.edges_listed = !model.edges.empty();
    const bool only_points = model.edges.empty() && model.faces.empty() && model.circles.empty();
    std::vector<std::uint32_t> moved(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!used_[i] && !only_points) continue;
      moved[i] = static_cast<std::uint32_t>(model.points.size());
      model.points.push_back({FeatureType::kVertex, points_[i]});
    }
    for (auto& [a, b] : model.edges) {
      a = moved[a];
      b = moved[b];
    }
    for (auto& face : model.faces) {
      for (std::uint32_t& corner : face) corner = moved[corner];
    }
    add_face_sides();
    return std::move(draft_);
  }

  // Where a file has lines and faces, the sides of faces are lines too.
  void add_face_sides() {
    if (!draft_.edges_listed) {
      draft_.model.edges.clear();
      return;
    }
    for (const auto& face : draft_.model.faces) {
      for (std::size_t i = 0; i < face.size(); ++i) {
        draft_.model.edges.push_back({face[i], face[(i + 1) % face.size()]});
      }
    }
  }

  static constexpr std::size_t kMaxCaoPoints = 4 * kMaxModelPoints;  // with helper points

  const Input& input_;
  double scale_;
  const LoadPart& load_;
  LineReader lines_;
  std::string_view rest_{};  // of the record
  bool pending_ = false;     // rest_ was read but not used
  std::size_t first_own_ = 0;
  std::vector<Eigen::Vector3d> points_{};
  std::vector<bool> used_{};
  std::vector<std::array<std::uint32_t, 2>> cao_lines_{};
  std::vector<std::array<std::uint32_t, 2>> part_edges_{};
  ModelDraft draft_{};
};

}  // namespace

ModelDraft parse_cao(const Input& input, const ReadModelOptions& options, const LoadPart& load) {
  return CaoReader(input, metres_per(options.units.value_or(Units::kMetres)), load).read();
}

}  // namespace landmarkdb
