#include "engine/cloud/spatial_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nanoflann.hpp>

namespace landmarkdb {
namespace {

struct Points {
  std::span<const Eigen::Vector3f> points;
  const RunContext* building = nullptr;  // while the tree is built
  mutable std::uint64_t looks = 0;

  // The names nanoflann asks for.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    constexpr std::uint64_t kStep = 1 << 20;  // some ten milliseconds
    if (building != nullptr && ++looks % kStep == 0) building->check("index");
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// NOLINTBEGIN(readability-identifier-naming): evalMetric is nanoflann's name.
// Its own metric, but past the question whether the tree is being built: searches ask it for every
// point they meet.
struct Metric : nanoflann::L2_Simple_Adaptor<float, Points, float, std::uint32_t> {
  using L2_Simple_Adaptor::L2_Simple_Adaptor;
  float evalMetric(const float* a, std::uint32_t b, std::size_t) const {
    const Eigen::Vector3f& p = data_source.points[b];
    float sum = 0.0F;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const float difference = a[axis] - p[axis];
      sum += difference * difference;
    }
    return sum;
  }
};
// NOLINTEND(readability-identifier-naming)

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Points, 3, std::uint32_t>;

constexpr std::size_t kLeafPoints = 12;  // near nanoflann's default of 10
// The tree's lower bounds carry rounding errors; this much of slack makes the search exact again.
constexpr float kBoundSlack = -1e-5F;

bool closer(const Neighbour& a, const Neighbour& b) {
  return a.squared_distance_m2 < b.squared_distance_m2 ||
         (a.squared_distance_m2 == b.squared_distance_m2 && a.index < b.index);
}

// nanoflann takes a point that is nearer than worstDist(); ours takes ties too, hence the step up.
float just_above(float value) {
  return std::nextafter(value, std::numeric_limits<float>::infinity());
}

// NOLINTBEGIN(readability-identifier-naming): worstDist and addPoint are nanoflann's names.
class NearestResult {
 public:
  NearestResult(std::size_t k, std::vector<Neighbour>& out) : k_(k), out_(out) {}

  std::size_t size() const { return out_.size(); }
  bool full() const { return out_.size() == k_; }
  float worstDist() const {
    return full() ? just_above(out_.back().squared_distance_m2)
                  : std::numeric_limits<float>::infinity();
  }
  bool addPoint(float squared_distance, std::uint32_t index) {
    const Neighbour candidate{index, squared_distance};
    if (full()) {
      if (!closer(candidate, out_.back())) return true;
      out_.pop_back();
    }
    auto place = out_.end();
    while (place != out_.begin() && closer(candidate, *(place - 1))) --place;
    out_.insert(place, candidate);
    return true;
  }

 private:
  std::size_t k_;
  std::vector<Neighbour>& out_;
};

class WithinResult {
 public:
  WithinResult(float squared_radius, std::vector<Neighbour>& out)
      : limit_(just_above(squared_radius)), out_(out) {}

  std::size_t size() const { return out_.size(); }
  bool full() const { return true; }
  float worstDist() const { return limit_; }
  bool addPoint(float squared_distance, std::uint32_t index) {
    out_.push_back({index, squared_distance});
    return true;
  }

 private:
  float limit_;
  std::vector<Neighbour>& out_;
};

// NOLINTEND(readability-identifier-naming)

}  // namespace

struct SpatialIndex::Tree {
  Tree(std::span<const Eigen::Vector3f> points, const RunContext& context)
      : data{points, &context},
        index(3, data, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints)) {
    data.building = nullptr;
  }

  Points data;
  KdTree index;
};

SpatialIndex::SpatialIndex(std::span<const Eigen::Vector3f> points, const RunContext& context)
    : tree_(std::make_unique<Tree>(points, context)) {}
SpatialIndex::~SpatialIndex() = default;
SpatialIndex::SpatialIndex(SpatialIndex&&) noexcept = default;
SpatialIndex& SpatialIndex::operator=(SpatialIndex&&) noexcept = default;

void SpatialIndex::nearest(const Eigen::Vector3f& query,
                           std::size_t k,
                           std::vector<Neighbour>& out) const {
  out.clear();
  k = std::min(k, tree_->data.points.size());
  if (k == 0) return;
  out.reserve(k);
  NearestResult result(k, out);
  tree_->index.findNeighbors(result, query.data(), {32, kBoundSlack, false});
}

void SpatialIndex::within_unordered(const Eigen::Vector3f& query,
                                    float radius_m,
                                    std::vector<Neighbour>& out) const {
  out.clear();
  if (tree_->data.points.empty() || !(radius_m >= 0.0F)) return;
  WithinResult result(radius_m * radius_m, out);
  tree_->index.findNeighbors(result, query.data(), {32, kBoundSlack, false});
}

void SpatialIndex::within(const Eigen::Vector3f& query,
                          float radius_m,
                          std::vector<Neighbour>& out) const {
  within_unordered(query, radius_m, out);
  std::sort(out.begin(), out.end(), closer);
}

}  // namespace landmarkdb
