#include "engine/features/iss_keypoints.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Eigenvalues>

#include "engine/base/parallel.hpp"
#include "engine/cloud/cell_grid.hpp"

namespace landmarkdb {
namespace {

constexpr double kCellsPerRadius = 2.0;  // as in describe_shot
constexpr std::size_t kBlock = 256;      // points between two looks at the stop request

// Rounding leaves the smallest eigenvalue of a plane at some 1e-7 of the largest (float input);
// below this share a point is on a plane, not salient.
constexpr double kFlat = 1e-6;

// Smallest eigenvalue of the scatter about the point itself, 0 where the point is not salient.
double saliency(const CellGrid& grid,
                const Eigen::Vector3f& centre,
                const std::vector<CellGrid::Found>& found,
                const IssOptions& options) {
  if (found.size() < options.min_neighbours) return 0.0;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const CellGrid::Found& f : found) {
    const Eigen::Vector3d offset = (grid.point(f.place) - centre).cast<double>();
    scatter += offset * offset.transpose();
  }
  scatter /= static_cast<double>(found.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  const double e1 = solver.eigenvalues()[2];
  const double e2 = solver.eigenvalues()[1];
  const double e3 = solver.eigenvalues()[0];
  if (!(e3 > kFlat * e1)) return 0.0;
  return e2 < options.max_ratio_21 * e1 && e3 < options.max_ratio_32 * e2 ? e3 : 0.0;
}

}  // namespace

Keypoints iss_keypoints(const PreparedCloud& cloud,
                        const IssOptions& options,
                        const RunContext& context) {
  if (cloud.points.empty()) return {};
  const CellGrid grid(cloud.points, options.salient_radius_m / kCellsPerRadius);
  std::vector<double> salient(grid.size());  // by place
  parallel_chunks(grid.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<CellGrid::Found> found;
    for (std::size_t place = begin; place < end; ++place) {
      if ((place - begin) % kBlock == 0) context.check("keypoints");
      const Eigen::Vector3f centre = grid.point(place);
      grid.within(centre, static_cast<float>(options.salient_radius_m), found);
      salient[place] = saliency(grid, centre, found, options);
    }
  });
  std::vector<std::uint8_t> is_keypoint(grid.size());
  parallel_chunks(grid.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<CellGrid::Found> found;
    for (std::size_t place = begin; place < end; ++place) {
      if ((place - begin) % kBlock == 0) context.check("keypoints");
      if (salient[place] <= 0.0) continue;
      grid.within(grid.point(place), static_cast<float>(options.nms_radius_m), found);
      const bool beaten = std::any_of(found.begin(), found.end(), [&](const auto& f) {
        return salient[f.place] > salient[place];
      });
      is_keypoint[place] = !beaten && found.size() >= options.min_neighbours ? 1 : 0;
    }
  });
  Keypoints result;
  for (std::size_t place = 0; place < grid.size(); ++place) {
    if (is_keypoint[place] != 0) result.index.push_back(grid.order()[place]);
  }
  std::sort(result.index.begin(), result.index.end());
  return result;
}

}  // namespace landmarkdb
