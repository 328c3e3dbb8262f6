#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// Points sorted by the cubic cell they fall into, for the many fixed-radius searches of keypoints
// and descriptors: the cells of one column lie side by side, so a search is a few dozen runs over
// plain arrays. Exact; the order of results depends on the points alone. Holds copies. Const
// methods are thread-safe.
//
// A *place* is a point's position in the sorted order; `order()[place]` is its index as given.
class CellGrid {
 public:
  // `points` finite. Throws Error{kInvalidArgument} for a cell that is not positive and finite, or
  // so small that the cloud spans more than 2^21 of them on one axis.
  CellGrid(std::span<const Eigen::Vector3f> points, double cell_m);

  struct Found {
    std::uint32_t place = 0;
    float squared_distance_m2 = 0.0F;
  };

  // All points nearer than `radius_m`, in the order of places. `out` is overwritten.
  void within(const Eigen::Vector3f& query, float radius_m, std::vector<Found>& out) const;

  // Places `begin .. end - 1`.
  struct Run {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  // The runs of places that hold every point nearer than `radius_m`, and others near by. Ascending,
  // without overlap. `out` is overwritten.
  void runs(const Eigen::Vector3f& query, float radius_m, std::vector<Run>& out) const;

  // The occupied cells, and the places of one of them.
  std::size_t cells() const { return keys_.size(); }
  Run cell(std::size_t i) const { return {start_[i], start_[i + 1]}; }

  // Holds all points of some places.
  struct Ball {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    float radius_m = 0.0F;
  };
  Ball ball_around(const Run& places) const;

  std::size_t size() const { return order_.size(); }
  std::span<const std::uint32_t> order() const { return order_; }
  std::span<const float> x() const { return x_; }  // by place
  std::span<const float> y() const { return y_; }
  std::span<const float> z() const { return z_; }
  Eigen::Vector3f point(std::size_t place) const { return {x_[place], y_[place], z_[place]}; }

 private:
  std::array<std::int64_t, 3> cell_of(const Eigen::Vector3d& p) const;
  void index_columns();
  // The places of the cells cz_low .. cz_high of one column.
  Run column_run(std::int64_t cx, std::int64_t cy, std::int64_t cz_low, std::int64_t cz_high) const;

  Eigen::Vector3d min_ = Eigen::Vector3d::Zero();
  double cell_m_ = 0.0;
  std::array<std::int64_t, 3> last_{};  // the highest cell on each axis
  std::vector<std::uint32_t> order_;
  std::vector<float> x_, y_, z_;
  std::vector<std::uint64_t> keys_;   // of the occupied cells, ascending
  std::vector<std::uint32_t> start_;  // first place of each, and the number of points at the end
  // Index into keys_ of the first cell of each column (x * columns along y + y) and of the end;
  // empty where the cloud is so wide that most columns would be.
  std::vector<std::uint32_t> columns_;
};

// The cell of each point, packed x-y-z into 64 bits, 21 bits an axis, counted from the cloud's
// smallest corner. Throws like CellGrid.
struct CellKeys {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  std::array<std::int64_t, 3> last{};
  std::vector<std::uint64_t> keys;  // one a point
};
CellKeys make_cell_keys(std::span<const Eigen::Vector3f> points, double cell_m);

std::uint64_t pack_cell(std::int64_t x, std::int64_t y, std::int64_t z);
std::array<std::int64_t, 3> unpack_cell(std::uint64_t key);

}  // namespace landmarkdb
