#include "engine/mono/edge_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/mono/edge_consensus.hpp"

namespace landmarkdb {
namespace {

constexpr double kStep_px = 4.0;
constexpr double kReach_px = 4.0;
constexpr double kCosine = 0.9396926;     // 20 degrees
constexpr std::size_t kMostSamples = 60;  // of an edge
constexpr std::size_t kFewestSamples = 3;

struct Seen {
  Eigen::Vector2d uv;
  Eigen::Vector2d normal;
};

class EdgeJudge {
 public:
  EdgeJudge(const SearchModel& model,
            const Camera& camera,
            const RigidPose& pose,
            const EdgeGrid& grid,
            double scale)
      : model_(model),
        camera_(camera),
        pose_(pose),
        grid_(grid),
        scale_(scale),
        sight_(model.visibility, -(pose.R.transpose() * pose.t)) {
    for (const ModelFeature& point : model.model().points)
      corners_.push_back(project_place(point.xyz));
  }

  EdgeEvidence judge() {
    for (const auto& [a, b] : model_.model().edges) judge_edge(a, b);
    EdgeEvidence result;
    if (ends_ > 0.0) result.overrun = overrun_ / ends_;
    judge_lines(model_, camera_, pose_, grid_, scale_, result);
    return result;
  }

 private:
  std::optional<Eigen::Vector2d> project_place(const Eigen::Vector3d& place) const {
    return project(camera_, pose_ * place);
  }

  // 0: no image edge there; else which side is the brighter.
  int side_at(const Eigen::Vector2d& uv, const Eigen::Vector2d& normal, double reach) const {
    const EdgePoint* edge = grid_.nearest(uv, normal, reach * scale_, kCosine);
    if (edge == nullptr) return 0;
    return edge->normal.cast<double>().dot(normal) > 0.0 ? 1 : -1;
  }

  void judge_edge(std::uint32_t a, std::uint32_t b) {
    if (!corners_[a] || !corners_[b]) return;
    const Eigen::Vector2d from = *corners_[a], to = *corners_[b];
    const double length = (to - from).norm();
    const auto n = static_cast<std::size_t>(std::min<double>(
        static_cast<double>(kMostSamples), std::floor(length / (kStep_px * scale_))));
    if (n < kFewestSamples) return;
    const Eigen::Vector2d along = (to - from) / length, normal(-along.y(), along.x());
    const Eigen::Vector3d &A = model_.model().points[a].xyz, &B = model_.model().points[b].xyz;
    std::vector<int> sides;  // of the visible samples
    std::array<std::size_t, 2> of_side{};
    bool first_seen = false, last_seen = false;
    for (std::size_t i = 0; i < n; ++i) {
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      const Eigen::Vector3d place = A + at * (B - A);
      const std::optional<Eigen::Vector2d> uv = project_place(place);
      const bool seen = uv && in_image(camera_, *uv) && sight_.sees(place);
      if (i == 0) first_seen = seen;
      if (i + 1 == n) last_seen = seen;
      if (!seen) continue;
      const int side = side_at(*uv, normal, kReach_px);
      sides.push_back(side);
      if (side != 0) ++of_side[side > 0 ? 1 : 0];
    }
    if (sides.size() < kFewestSamples) return;
    const int side = of_side[1] >= of_side[0] ? 1 : -1;
    const auto runs_to = [&](auto begin) {  // the three samples next to an end
      return std::all_of(begin, begin + kFewestSamples, [&](int s) { return s == side; });
    };
    if (first_seen && runs_to(sides.begin())) judge_end(a, b, -along, normal, side);
    if (last_seen && runs_to(sides.rbegin())) judge_end(b, a, along, normal, side);
  }

  // Past corner `at` of its edge to `other`, along `on`.
  void judge_end(std::uint32_t at,
                 std::uint32_t other,
                 const Eigen::Vector2d& on,
                 const Eigen::Vector2d& normal,
                 int side) {
    constexpr double kGoesOn = 0.9;  // cosine: another edge of the model continues this one
    constexpr double kFirst_px = 5.0, kNext_px = 2.5, kNarrow_px = 2.0;
    constexpr int kSamples = 5, kEnough = 4;
    for (const std::uint32_t next : model_.neighbours[at]) {
      if (next == other || !corners_[next]) continue;
      if ((*corners_[next] - *corners_[at]).normalized().dot(on) > kGoesOn) return;
    }
    int hits = 0;
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Vector2d uv = *corners_[at] + (kFirst_px + kNext_px * i) * scale_ * on;
      if (!in_image(camera_, uv)) return;
      hits += side_at(uv, normal, kNarrow_px) == side ? 1 : 0;
    }
    ends_ += 1.0;
    overrun_ += hits >= kEnough ? 1.0 : 0.0;
  }

  const SearchModel& model_;
  const Camera& camera_;
  const RigidPose& pose_;
  const EdgeGrid& grid_;
  double scale_;
  PlaceSight sight_;
  std::vector<std::optional<Eigen::Vector2d>> corners_;  // of the model's points, in the image
  double ends_ = 0.0, overrun_ = 0.0;
};

}  // namespace

EdgeEvidence judge_edges(const SearchModel& model,
                         const Camera& camera,
                         const RigidPose& pose,
                         const EdgeGrid& grid,
                         double scale) {
  return EdgeJudge(model, camera, pose, grid, scale).judge();
}

}  // namespace landmarkdb
