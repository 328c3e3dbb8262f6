#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/features/shot_kernel.hpp"
#include "engine/features/shot_share.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kBlock = 256;  // points a pass: its arrays stay in the first-level cache
static_assert(kBlock % kShotLanes == 0);

using Places = std::array<std::int32_t, kBlock>;
using Weights = std::array<float, kBlock>;

ShotAxes axes_of(const Eigen::Matrix3f& R_cloud_lrf, float radius_m) {
  ShotAxes axes{};
  for (int row = 0; row < 3; ++row) {
    axes.x[row] = R_cloud_lrf(row, 0);
    axes.y[row] = R_cloud_lrf(row, 1);
    axes.z[row] = R_cloud_lrf(row, 2);
  }
  axes.radius = radius_m;
  return axes;
}

void add_shares(const ShotShares& shares, std::size_t count, float* values) {
  for (std::size_t i = 0; i < count; ++i) {
    values[shares.cosine[i]] += shares.cosine_weight[i];
    values[shares.shell[i]] += shares.shell_weight[i];
    values[shares.elevation[i]] += shares.elevation_weight[i];
    values[shares.azimuth[i]] += shares.azimuth_weight[i];
    values[shares.own[i]] += shares.own_weight[i];
  }
}

bool normalise(float* values) {
  double squared = 0.0;
  for (std::size_t i = 0; i < kShotLength; ++i) {
    squared += static_cast<double>(values[i]) * static_cast<double>(values[i]);
  }
  if (!(squared > 0.0) || !std::isfinite(squared)) return false;
  const auto length = static_cast<float>(std::sqrt(squared));
  for (std::size_t i = 0; i < kShotLength; ++i) values[i] /= length;
  return true;
}

}  // namespace

bool shot_histogram(const Neighbourhood& points,
                    const Eigen::Matrix3f& R_cloud_lrf,
                    float radius_m,
                    float* values) {
  const ShotShare share = shot_share();
  const ShotAxes axes = axes_of(R_cloud_lrf, radius_m);
  Places own, cosine, shell, elevation, azimuth;  // NOLINT(*-member-init): share() fills them
  Weights own_weight, cosine_weight, shell_weight, elevation_weight,  // NOLINT(*-member-init)
      azimuth_weight;
  ShotShares shares{own.data(),
                    cosine.data(),
                    shell.data(),
                    elevation.data(),
                    azimuth.data(),
                    own_weight.data(),
                    cosine_weight.data(),
                    shell_weight.data(),
                    elevation_weight.data(),
                    azimuth_weight.data()};
  std::fill_n(values, kShotLength, 0.0F);
  for (std::size_t first = 0; first < points.count; first += kBlock) {
    const std::size_t count = std::min(kBlock, points.count - first);
    const ShotPoints block{points.x.data() + first,
                           points.y.data() + first,
                           points.z.data() + first,
                           points.nx.data() + first,
                           points.ny.data() + first,
                           points.nz.data() + first,
                           points.squared_m2.data() + first};
    share(block, count, axes, shares);
    add_shares(shares, count, values);
  }
  return normalise(values);
}

}  // namespace landmarkdb
