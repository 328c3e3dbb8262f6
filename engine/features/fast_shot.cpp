#include <cstddef>
#include <vector>

#include "engine/features/shot_describer.hpp"
#include "engine/features/shot_kernel.hpp"

namespace landmarkdb {
namespace {

class FastShot : public ShotDescriber {
 public:
  FastShot(const CellGrid& grid, std::span<const Eigen::Vector3f> normals, float radius_m)
      : grid_(grid), radius_m_(radius_m) {
    nx_.reserve(grid.size());
    ny_.reserve(grid.size());
    nz_.reserve(grid.size());
    for (const std::uint32_t index : grid.order()) {
      nx_.push_back(normals[index].x());
      ny_.push_back(normals[index].y());
      nz_.push_back(normals[index].z());
    }
  }

  void describe(std::span<const std::uint32_t> places,
                std::span<ShotRow> rows,
                std::span<float* const> values) const override {
    std::vector<CellGrid::Run> runs;
    Neighbourhood points;
    for (std::size_t i = 0; i < places.size(); ++i) {
      gather(grid_.point(places[i]), runs, points);
      rows[i].valid = shot_frame(points, radius_m_, rows[i].frame) &&
                      shot_histogram(points, rows[i].frame, radius_m_, values[i]);
    }
  }

 private:
  // Every point of the runs is written, those out of reach are written over by the next: which are
  // in reach changes too often for a branch.
  void gather(const Eigen::Vector3f& centre,
              std::vector<CellGrid::Run>& runs,
              Neighbourhood& points) const {
    grid_.runs(centre, radius_m_, runs);
    std::size_t most = 1;
    for (const CellGrid::Run& run : runs) most += run.end - run.begin;
    points.reserve(most);
    const float* const x = grid_.x().data();
    const float* const y = grid_.y().data();
    const float* const z = grid_.z().data();
    const float limit = radius_m_ * radius_m_;
    std::size_t count = 0;
    for (const CellGrid::Run& run : runs) {
      for (std::uint32_t place = run.begin; place < run.end; ++place) {
        const float dx = x[place] - centre.x();
        const float dy = y[place] - centre.y();
        const float dz = z[place] - centre.z();
        const float squared = dx * dx + dy * dy + dz * dz;
        points.x[count] = dx;
        points.y[count] = dy;
        points.z[count] = dz;
        points.nx[count] = nx_[place];
        points.ny[count] = ny_[place];
        points.nz[count] = nz_[place];
        points.squared_m2[count] = squared;
        count += (squared < limit) & (squared > 0.0F) ? 1U : 0U;
      }
    }
    points.count = count;
  }

  const CellGrid& grid_;
  float radius_m_;
  std::vector<float> nx_, ny_, nz_;  // by place
};

}  // namespace

std::unique_ptr<ShotDescriber> make_fast_shot(const CellGrid& grid,
                                              std::span<const Eigen::Vector3f> normals,
                                              float radius_m) {
  return std::make_unique<FastShot>(grid, normals, radius_m);
}

}  // namespace landmarkdb
