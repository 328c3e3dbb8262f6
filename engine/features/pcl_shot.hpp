#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "engine/features/cell_grid.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// One keypoint's outcome; `valid` false: no frame or no histogram is defined there.
struct ShotRow {
  bool valid = false;
  Eigen::Matrix3f frame = Eigen::Matrix3f::Identity();  // R_cloud_lrf
};

// PCL's SHOT behind plain data. Built once a cloud and shared by threads; describe() is const and
// thread-safe (each call has its own estimators, all read the same cloud).
class PclShot {
 public:
  // `grid` must outlive this object; `normals[i]` belongs to the point of index i. All finite.
  PclShot(const CellGrid& grid, std::span<const Eigen::Vector3f> normals, float radius_m);
  ~PclShot();
  PclShot(const PclShot&) = delete;
  PclShot& operator=(const PclShot&) = delete;

  // Describes the points at `places` of the grid. `rows` has one element a place, `values` one row
  // of kShotLength; rows that are not valid leave their values untouched.
  void describe(std::span<const std::uint32_t> places,
                std::span<ShotRow> rows,
                std::span<float* const> values) const;

 private:
  struct Clouds;
  const CellGrid& grid_;
  float radius_m_;
  std::unique_ptr<const Clouds> clouds_;
};

}  // namespace landmarkdb
