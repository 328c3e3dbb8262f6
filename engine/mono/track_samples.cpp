#include "engine/mono/track_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace landmarkdb {
namespace {

// A curve of the model: from a to b, or once around a circle.
struct Curve {
  Eigen::Vector3d a, b;  // an edge's ends; a circle's centre and (unused)
  Eigen::Vector3d u = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();  // a circle's radii
  bool circle = false;

  Eigen::Vector3d at(double share) const {
    if (!circle) return a + share * (b - a);
    const double angle = 2.0 * std::numbers::pi * share;
    return a + std::cos(angle) * u + std::sin(angle) * v;
  }
  Eigen::Vector3d direction(double share) const {
    if (!circle) return b - a;
    const double angle = 2.0 * std::numbers::pi * share;
    return -std::sin(angle) * u + std::cos(angle) * v;
  }
};

std::vector<Curve> curves_of(const MonoModel& model) {
  std::vector<Curve> curves;
  curves.reserve(model.edges.size() + model.circles.size());
  for (const auto& [from, to] : model.edges) {
    curves.push_back({.a = model.points[from].xyz, .b = model.points[to].xyz});
  }
  for (const ModelCircle& circle : model.circles) {
    const Eigen::Vector3d u = circle.normal.unitOrthogonal();
    curves.push_back({.a = circle.center,
                      .b = circle.center,
                      .u = circle.radius_m * u,
                      .v = circle.radius_m * circle.normal.cross(u),
                      .circle = true});
  }
  return curves;
}

// The length of a curve in the image, from a few chords; what is not seen counts as nothing.
double length_px(const Curve& curve, const Camera& camera, const RigidPose& pose) {
  constexpr int kChords = 8;
  double length = 0.0;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  bool last_seen = false;
  for (int k = 0; k <= kChords; ++k) {
    const std::optional<Eigen::Vector2d> uv =
        project(camera, pose * curve.at(static_cast<double>(k) / kChords));
    if (uv && last_seen) length += (*uv - last).norm();
    last_seen = uv.has_value();
    if (uv) last = *uv;
  }
  // A curve that leaves the image by far is not sampled beyond what an image is long.
  return std::min(length, 4.0 * static_cast<double>(std::max(camera.width, camera.height)));
}

// Where the place is seen and the unit normal of the curve there; nullopt where it is not.
std::optional<TrackSample> sample_at(const Curve& curve,
                                     double share,
                                     const Camera& camera,
                                     const RigidPose& pose,
                                     double border_px) {
  TrackSample sample;
  sample.share = share;
  sample.xyz = curve.at(share);
  const Eigen::Vector3d X = pose * sample.xyz;
  if (!(X.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d ray = X.head<2>() / X.z();
  if (!inside_lens_model(camera, ray)) return std::nullopt;
  const LensPoint seen = distort_with_slope(camera, ray);
  const double right = static_cast<double>(camera.width) - 1.0 - border_px;
  const double bottom = static_cast<double>(camera.height) - 1.0 - border_px;
  if (!(seen.uv.x() >= border_px && seen.uv.y() >= border_px && seen.uv.x() <= right &&
        seen.uv.y() <= bottom)) {
    return std::nullopt;
  }
  const Eigen::Vector3d D = pose.R * curve.direction(share);
  const Eigen::Vector2d along = seen.duv_dray * (D.head<2>() - ray * D.z());
  if (!(along.norm() > 0.0)) return std::nullopt;
  sample.uv = seen.uv;
  sample.normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
  return sample;
}

void mark_crowded(std::vector<TrackSample>& samples, double crowd_px, double step_px) {
  constexpr double kParallel = 0.94;  // cosine of 20 degrees
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t k = i + 1; k < samples.size(); ++k) {
      TrackSample& a = samples[i];
      TrackSample& b = samples[k];
      if (a.curve == b.curve) continue;
      const Eigen::Vector2d off = b.uv - a.uv;
      if (std::abs(off.x()) > crowd_px + step_px || std::abs(off.y()) > crowd_px + step_px)
        continue;
      if (std::abs(a.normal.dot(b.normal)) < kParallel) continue;
      const double across = std::abs(off.dot(a.normal));
      const double along = std::abs(off.x() * a.normal.y() - off.y() * a.normal.x());
      if (across < crowd_px && along < step_px) a.crowded = b.crowded = true;
    }
  }
}

}  // namespace

std::vector<TrackSample> track_samples(const MonoModel& model,
                                       const ModelVisibility& visibility,
                                       const Camera& camera,
                                       const RigidPose& pose,
                                       const TrackSampleOptions& options) {
  const std::vector<Curve> curves = curves_of(model);
  std::vector<double> lengths;
  double total_px = 0.0;
  for (const Curve& curve : curves) {
    lengths.push_back(length_px(curve, camera, pose));
    total_px += lengths.back();
  }
  const double step_px = std::max(
      options.step_px, total_px / static_cast<double>(std::max<std::size_t>(options.most, 1)));
  const PlaceSight sight(visibility, -(pose.R.transpose() * pose.t));
  std::vector<TrackSample> samples;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const double end_px = curves[k].circle ? 0.0 : options.end_px;
    const double inner_px = lengths[k] - 2.0 * end_px;
    if (!(inner_px > 0.0)) continue;
    const auto count = static_cast<std::size_t>(std::ceil(inner_px / step_px));
    for (std::size_t i = 0; i < count; ++i) {
      const double share =
          (end_px + inner_px * (static_cast<double>(i) + 0.5) / static_cast<double>(count)) /
          lengths[k];
      std::optional<TrackSample> sample =
          sample_at(curves[k], share, camera, pose, options.border_px);
      if (!sample || !sight.sees(sample->xyz)) continue;
      sample->curve = static_cast<std::uint32_t>(k);
      samples.push_back(*sample);
    }
  }
  mark_crowded(samples, options.crowd_px, step_px);
  return samples;
}

}  // namespace landmarkdb
