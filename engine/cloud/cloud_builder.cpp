#include "engine/cloud/cloud_builder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/cloud/scalar.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kFirstPoints =
    4096;                                 // enough for a median that a few stray points cannot move
constexpr double kFloatKeeps_m = 1000.0;  // below 1024 m neighbouring floats are 0.06 mm apart
constexpr double kRound_m = 100.0;
constexpr double kFarthestOrigin_m = 1e15;  // beyond, doubles lose the decimetre too

Eigen::Vector3f to_local(const Eigen::Vector3d& p, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d local = p - origin;
  return {to_float(local.x()), to_float(local.y()), to_float(local.z())};
}

}  // namespace

Eigen::Vector3d round_origin(const Eigen::Vector3d& p) {
  const double far = p.cwiseAbs().maxCoeff();
  if (!(far > kFloatKeeps_m && far < kFarthestOrigin_m)) return Eigen::Vector3d::Zero();
  return (p / kRound_m).array().round() * kRound_m;
}

CloudBuilder::CloudBuilder(double metres) : metres_(metres) {}

void CloudBuilder::hand_to(const CloudSink& sink, std::span<const Eigen::Vector3d> viewpoints) {
  sink_ = &sink;
  viewpoints_.assign(viewpoints.begin(), viewpoints.end());
}

void CloudBuilder::reserve(std::size_t points, bool normals, bool colours) {
  expected_ = points;
  normals_ = normals;
  colours_ = colours;
  reserve_block();
}

void CloudBuilder::reserve_block() {
  const std::size_t most = sink_ != nullptr ? sink_->block_points : expected_;
  const std::size_t points = std::min(most, expected_ - std::min(expected_, handed_));
  cloud_.points.reserve(points);
  if (normals_) cloud_.normals.reserve(points);
  if (colours_) cloud_.colours.reserve(points);
}

PointCloud CloudBuilder::take_block() {
  for (const Eigen::Vector3d& viewpoint : viewpoints_) {
    cloud_.viewpoints.push_back(to_local(metres_ * viewpoint, cloud_.origin));
  }
  return std::exchange(cloud_, {});
}

void CloudBuilder::add_point(const Eigen::Vector3d& p_file) {
  if (sink_ != nullptr && cloud_.points.size() >= sink_->block_points) {
    const Eigen::Vector3d origin = cloud_.origin;
    handed_ += cloud_.points.size();
    sink_->take(take_block());
    cloud_.origin = origin;
    reserve_block();
  }
  const Eigen::Vector3d p = metres_ * p_file;
  if (decided_) {
    cloud_.points.push_back(to_local(p, cloud_.origin));
    return;
  }
  pending_.push_back(p);
  if (pending_.size() >= kFirstPoints) decide_origin();
}

void CloudBuilder::add_normal(const Eigen::Vector3d& n_file) {
  cloud_.normals.push_back(to_local(n_file, Eigen::Vector3d::Zero()));
}

void CloudBuilder::add_colour(const std::array<std::uint8_t, 3>& colour) {
  cloud_.colours.push_back(colour);
}

void CloudBuilder::add_viewpoint_index(std::uint16_t index) {
  cloud_.viewpoint_index.push_back(index);
}

void CloudBuilder::decide_origin() {
  Eigen::Vector3d median = Eigen::Vector3d::Zero();
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (const Eigen::Vector3d& p : pending_) {
      if (p.allFinite()) values.push_back(p[axis]);
    }
    if (values.empty()) break;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  cloud_.origin = round_origin(median);
  decided_ = true;
  for (const Eigen::Vector3d& p : pending_) cloud_.points.push_back(to_local(p, cloud_.origin));
  pending_ = {};
}

PointCloud CloudBuilder::finish() {
  if (!decided_) decide_origin();
  return take_block();
}

}  // namespace landmarkdb
