#include "engine/registration/pose_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/random.hpp"

namespace landmarkdb {

namespace {

constexpr int kBinsPerAxis = 5;  // normal components are cut into fifths: 98 bins touch the sphere
constexpr std::size_t kBins = kBinsPerAxis * kBinsPerAxis * kBinsPerAxis;

std::size_t direction_bin(const Eigen::Vector3f& n) {
  const auto bin = [](float v) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((v + 1.0F) * 0.5F * kBinsPerAxis), 0, kBinsPerAxis - 1));
  };
  return bin(n.x()) + kBinsPerAxis * (bin(n.y()) + kBinsPerAxis * bin(n.z()));
}

}  // namespace

TestPoints select_test_points(std::span<const Eigen::Vector3f> points,
                              std::span<const Eigen::Vector3f> normals,
                              std::span<const float> weights,
                              std::size_t count,
                              std::uint64_t seed) {
  std::array<std::size_t, kBins> population{};
  for (const Eigen::Vector3f& n : normals) ++population[direction_bin(n)];
  // Weighted draw without replacement (Efraimidis and Spirakis 2006): the smallest -log(u) / w come
  // first.
  Random random(seed);
  std::vector<std::pair<double, std::uint32_t>> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = (weights.empty() ? 1.0 : static_cast<double>(weights[i])) /
                          std::sqrt(static_cast<double>(population[direction_bin(normals[i])]));
    keys[i] = {-std::log(1.0 - random.uniform()) / weight, static_cast<std::uint32_t>(i)};
  }
  const std::size_t taken = std::min(count, keys.size());
  std::partial_sort(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(taken), keys.end());
  std::vector<Eigen::Vector3f> drawn;
  std::vector<Eigen::Vector3f> drawn_normals;
  drawn.reserve(taken);
  drawn_normals.reserve(taken);
  for (std::size_t i = 0; i < taken; ++i) {
    drawn.push_back(points[keys[i].second]);
    drawn_normals.push_back(normals[keys[i].second]);
  }
  return {std::move(drawn), std::move(drawn_normals)};
}

float score_pose(const SurfaceGrid& target,
                 const TestPoints& test,
                 std::size_t count,
                 const Eigen::Matrix3f& R_target_source,
                 const Eigen::Vector3f& t_target_source,
                 const ScoreOptions& options) {
  const PointGroups& all = test.groups();
  const std::size_t groups = std::min(PointGroups::groups_for(count), all.groups());
  if (groups == 0) return -1.0F;
  const float sigma = options.sigma_cells * target.cell_m();
  return pair_kernels().mean_fit(target,
                                 all.group(0),
                                 groups,
                                 all.size_of(groups),
                                 {R_target_source, t_target_source},
                                 {.factor = -0.5F / (sigma * sigma),
                                  .first_groups = PointGroups::groups_for(options.first_look),
                                  .hopeless = options.hopeless});
}

}  // namespace landmarkdb
