#include "engine/features/structure_keypoints.hpp"

#include <algorithm>
#include <cstddef>

#include <Eigen/Eigenvalues>

#include "engine/base/parallel.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/cloud/sort_by_key.hpp"

namespace landmarkdb {
namespace {

constexpr double kCellsPerRadius = 2.0;  // as in describe_shot
constexpr std::size_t kBlock = 256;      // keypoints between two looks at the stop request

float second_eigenvalue(const Eigen::Matrix3d& scatter) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return static_cast<float>(std::max(solver.eigenvalues()[1], 0.0));
}

}  // namespace

Keypoints uniform_keypoints(const PreparedCloud& cloud, double spacing_m) {
  const CellKeys cells = make_cell_keys(cloud.points, spacing_m);
  std::vector<Keyed> sorted;
  sorted.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    sorted.push_back({cells.keys[i], static_cast<std::uint32_t>(i)});
  }
  sort_by_key(sorted);
  Keypoints result;
  double least = 0.0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const auto [x, y, z] = unpack_cell(sorted[k].key);
    const Eigen::Vector3d middle(
        static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, static_cast<double>(z) + 0.5);
    const Eigen::Vector3d centre = cells.min + middle * spacing_m;
    const double squared = (cloud.points[sorted[k].index].cast<double>() - centre).squaredNorm();
    if (k == 0 || sorted[k].key != sorted[k - 1].key) {
      result.index.push_back(sorted[k].index);
    } else if (squared < least) {
      result.index.back() = sorted[k].index;
    } else {
      continue;
    }
    least = squared;
  }
  std::sort(result.index.begin(), result.index.end());
  return result;
}

std::vector<float> normal_spread(const PreparedCloud& cloud,
                                 const Keypoints& keypoints,
                                 double radius_m,
                                 const RunContext& context) {
  const CellGrid grid(cloud.points, radius_m / kCellsPerRadius);
  std::vector<Eigen::Vector3f> normals(grid.size());
  for (std::size_t place = 0; place < grid.size(); ++place) {
    normals[place] = cloud.normals[grid.order()[place]];
  }
  std::vector<float> spread(keypoints.size());
  parallel_chunks(keypoints.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<CellGrid::Found> found;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBlock == 0) context.check("keypoints");
      grid.within(cloud.points[keypoints.index[i]], static_cast<float>(radius_m), found);
      Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
      for (const CellGrid::Found& f : found) {
        const Eigen::Vector3f& n = normals[f.place];
        scatter += n * n.transpose();
      }
      const double count = static_cast<double>(std::max<std::size_t>(found.size(), 1));
      spread[i] = second_eigenvalue(scatter.cast<double>() / count);
    }
  });
  return spread;
}

}  // namespace landmarkdb
