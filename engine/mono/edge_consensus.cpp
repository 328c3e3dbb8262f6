#include "engine/mono/edge_consensus.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/LU>

namespace landmarkdb {
namespace {

constexpr double kStep_px = 4.0;
constexpr std::size_t kMostSamples = 24;  // of an edge
constexpr std::size_t kFewestSamples = 3;
constexpr double kCosine = 0.9396926;  // 20 degrees
constexpr double kOnLine_px = 1.0;
constexpr double kEdgeSigma_px = 0.7;  // of a line's place
constexpr double kModelSigma = 0.006;  // of the diameter: how far corners are off their model's
constexpr double kReach_px = 1.5;      // from a corner's own place, and
constexpr double kReachSigmas = 3.0;   // so much of what corners are off
constexpr double kPriceOfBend = 0.05;  // share of samples on a line that one sigma has to give

// An image edge that crosses the normal of a sample.
struct Crossing {
  double offset_px = 0.0;
  int side = 0;  // towards which the image is brighter, +-1
};

struct Sample {
  double at = 0.0;  // 0 to 1 along the edge
  std::vector<Crossing> crossings{};
};

// offset = from + (to - from) * at
struct Line {
  double from_px = 0.0, to_px = 0.0;
  int side = 0;
  std::size_t on = 0;
  double score = -1e9;

  double at(double s) const { return from_px + (to_px - from_px) * s; }
};

class Consensus {
 public:
  Consensus(const SearchModel& model,
            const Camera& camera,
            const RigidPose& pose,
            const EdgeGrid& grid,
            double scale)
      : model_(model),
        camera_(camera),
        pose_(pose),
        grid_(grid),
        scale_(scale),
        eye_(-(pose.R.transpose() * pose.t)),
        sight_(model.visibility, eye_),
        corners_(model.points.size()) {
    const double focal = 0.5 * (std::abs(camera.fx) + std::abs(camera.fy));
    sigma_px_ = kModelSigma * focal * model.model().diameter_m / (pose * model.center).z();
    sigma_px_ = std::hypot(sigma_px_, 0.5 * scale_);
    reach_px_ = kReach_px * scale_ + kReachSigmas * sigma_px_;
    for (Corner& corner : corners_) corner.A.diagonal().setConstant(1.0 / (sigma_px_ * sigma_px_));
  }

  void judge(EdgeEvidence& result) {
    for (const auto& [a, b] : model_.model().edges) judge_edge(a, b);
    for (const ModelCircle& circle : model_.model().circles) judge_circle(circle);
    result.supported = length_ > 0.0 ? on_ / length_ : 0.0;
    result.lined = whole_;
    for (const Corner& corner : corners_) energy_ -= corner.b.dot(corner.A.inverse() * corner.b);
    result.bend = ends_ > 0.0 ? energy_ / ends_ : 0.0;
  }

 private:
  struct Corner {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
  };

  std::optional<Eigen::Vector2d> project_place(const Eigen::Vector3d& place) const {
    return project(camera_, pose_ * place);
  }

  // Samples of an edge, were all of it seen.
  std::size_t taken(double length_px) const {
    return static_cast<std::size_t>(std::min<double>(static_cast<double>(kMostSamples),
                                                     std::floor(length_px / (kStep_px * scale_))));
  }

  std::vector<Sample> take_samples(const Eigen::Vector3d& A,
                                   const Eigen::Vector3d& B,
                                   const Eigen::Vector2d& normal,
                                   double length_px) const {
    const std::size_t n = taken(length_px);
    std::vector<Sample> samples;
    if (n < kFewestSamples) return samples;
    for (std::size_t i = 0; i < n; ++i) {
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      const Eigen::Vector3d place = A + at * (B - A);
      const std::optional<Eigen::Vector2d> uv = project_place(place);
      if (!uv || !in_image(camera_, *uv) || !sight_.sees(place)) continue;
      Sample& sample = samples.emplace_back(Sample{at, {}});
      grid_.for_each_across(*uv, normal, reach_px_, kCosine, [&](double offset, double cosine) {
        sample.crossings.push_back({offset, cosine > 0.0 ? 1 : -1});
      });
    }
    return samples;
  }

  double price(const Line& line) const {
    return kPriceOfBend * (line.from_px * line.from_px + line.to_px * line.to_px) /
           (2.0 * sigma_px_ * sigma_px_);
  }

  void count(const std::vector<Sample>& samples, Line& line) const {
    line.on = 0;
    for (const Sample& sample : samples) {
      const double wanted = line.at(sample.at);
      for (const Crossing& crossing : sample.crossings) {
        if (crossing.side != line.side ||
            std::abs(crossing.offset_px - wanted) > kOnLine_px * scale_)
          continue;
        ++line.on;
        break;
      }
    }
    line.score = static_cast<double>(line.on) / static_cast<double>(samples.size()) - price(line);
  }

  // The line through a crossing near the edge's one end and one near the other that most samples
  // lie on.
  Line best_line(const std::vector<Sample>& samples) const {
    constexpr std::size_t kAnchors = 4;
    std::vector<std::size_t> with;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (!samples[i].crossings.empty()) with.push_back(i);
    Line best;
    const std::size_t half = with.size() / 2, few = std::min(kAnchors, half);
    for (std::size_t i = 0; i < few; ++i) {
      for (std::size_t k = 0; k < few; ++k) {
        const Sample &a = samples[with[i]], &b = samples[with[with.size() - 1 - k]];
        for (const Crossing& from : a.crossings) {
          for (const Crossing& to : b.crossings) {
            if (from.side != to.side) continue;
            const double slope = (to.offset_px - from.offset_px) / (b.at - a.at);
            Line line;
            line.from_px = from.offset_px - slope * a.at;
            line.to_px = line.from_px + slope;
            line.side = from.side;
            if (std::max(std::abs(line.from_px), std::abs(line.to_px)) > reach_px_) continue;
            count(samples, line);
            if (line.score > best.score) best = line;
          }
        }
      }
    }
    return best;
  }

  // Least squares on the samples that lie on it.
  void settle(const std::vector<Sample>& samples, Line& line) const {
    double n = 0.0, s = 0.0, ss = 0.0, d = 0.0, sd = 0.0;
    for (const Sample& sample : samples) {
      double least = kOnLine_px * scale_, offset = 0.0;
      bool found = false;
      for (const Crossing& crossing : sample.crossings) {
        const double off = std::abs(crossing.offset_px - line.at(sample.at));
        if (crossing.side != line.side || off > least) continue;
        least = off;
        offset = crossing.offset_px;
        found = true;
      }
      if (!found) continue;
      n += 1.0;
      s += sample.at;
      ss += sample.at * sample.at;
      d += offset;
      sd += sample.at * offset;
    }
    const double determinant = n * ss - s * s;
    if (n < 3.0 || determinant < 1e-6) return;
    const double slope = (n * sd - s * d) / determinant;
    Line settled = line;
    settled.from_px = (d - slope * s) / n;
    settled.to_px = settled.from_px + slope;
    count(samples, settled);
    if (settled.score >= line.score) line = settled;
  }

  void judge_edge(std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3d &A = model_.model().points[a].xyz, &B = model_.model().points[b].xyz;
    const std::optional<Eigen::Vector2d> from = project_place(A), to = project_place(B);
    if (!from || !to) return;
    const double length_px = (*to - *from).norm();
    if (!(length_px > 0.0)) return;
    const Eigen::Vector2d along = (*to - *from) / length_px, normal(-along.y(), along.x());
    const std::vector<Sample> samples = take_samples(A, B, normal, length_px);
    if (samples.size() < kFewestSamples) return;
    Line line = best_line(samples);
    if (line.on > 0) settle(samples, line);
    const double share = static_cast<double>(line.on) / static_cast<double>(samples.size());
    add(share,
        length_px * static_cast<double>(samples.size()) / static_cast<double>(taken(length_px)));
    constexpr double kEnough = 0.6;
    if (share < kEnough) return;
    move_end(corners_[a], normal, line.from_px);
    move_end(corners_[b], normal, line.to_px);
  }

  void move_end(Corner& corner, const Eigen::Vector2d& normal, double offset_px) {
    const double weight = 1.0 / (kEdgeSigma_px * kEdgeSigma_px * scale_ * scale_);
    corner.A += weight * normal * normal.transpose();
    corner.b += weight * offset_px * normal;
    energy_ += weight * offset_px * offset_px;
    ends_ += 1.0;
  }

  void add(double share, double length_px) {
    constexpr double kWhole = 0.8;
    length_ += length_px;
    on_ += share * length_px;
    whole_ += share >= kWhole ? 1.0 : 0.0;
  }

  void judge_circle(const ModelCircle& circle) {
    constexpr std::size_t kSamples = 24;
    constexpr double kTurn = 2.0 * std::numbers::pi / double{kSamples};
    const Eigen::Vector3d n = circle.normal.normalized();
    const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
    std::array<double, 2> of_side{};
    double seen = 0.0, length_px = 0.0;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double angle = kTurn * static_cast<double>(i);
      const auto on_rim = [&](double at) {
        return Eigen::Vector3d(circle.center +
                               circle.radius_m * (std::cos(at) * u + std::sin(at) * v));
      };
      const Eigen::Vector3d place = on_rim(angle);
      const std::optional<Eigen::Vector2d> uv = project_place(place),
                                           next = project_place(on_rim(angle + 0.1));
      if (!uv || !next || !in_image(camera_, *uv) || !sight_.sees(place)) continue;
      const Eigen::Vector2d step = *next - *uv;
      if (!(step.norm() > 0.0)) continue;
      const Eigen::Vector2d normal = Eigen::Vector2d(-step.y(), step.x()).normalized();
      seen += 1.0;
      length_px += step.norm() * kTurn / 0.1;
      const EdgePoint* edge = grid_.nearest(*uv, normal, kOnLine_px * scale_ + sigma_px_, kCosine);
      if (edge == nullptr) continue;
      of_side[edge->normal.cast<double>().dot(normal) > 0.0 ? 1 : 0] += 1.0;
    }
    if (seen < double{kFewestSamples} || length_px < kStep_px * double{kFewestSamples}) return;
    add(std::max(of_side[0], of_side[1]) / seen, length_px);
  }

  const SearchModel& model_;
  const Camera& camera_;
  const RigidPose& pose_;
  const EdgeGrid& grid_;
  double scale_;
  Eigen::Vector3d eye_;
  PlaceSight sight_;
  std::vector<Corner> corners_;
  double sigma_px_ = 0.0, reach_px_ = 0.0;
  double length_ = 0.0, on_ = 0.0, whole_ = 0.0, energy_ = 0.0, ends_ = 0.0;
};

}  // namespace

void judge_lines(const SearchModel& model,
                 const Camera& camera,
                 const RigidPose& pose,
                 const EdgeGrid& grid,
                 double scale,
                 EdgeEvidence& evidence) {
  Consensus(model, camera, pose, grid, scale).judge(evidence);
}

}  // namespace landmarkdb
