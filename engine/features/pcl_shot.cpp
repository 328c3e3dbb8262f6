#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <pcl/features/shot.h>
#include <pcl/features/shot_lrf.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

#include "engine/base/error.hpp"
#include "engine/features/shot_describer.hpp"

namespace landmarkdb {
namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Frames = pcl::PointCloud<pcl::ReferenceFrame>;

// PCL defines no frame on fewer other points (shot_lrf.hpp).
constexpr std::size_t kMinNeighbours = 5;

// Answers PCL's radius searches from neighbour lists that were made beforehand, so that frame and
// histogram share one search, and no state is shared between threads.
class PreparedSearch : public pcl::search::Search<pcl::PointXYZ> {
 public:
  explicit PreparedSearch(const Points::ConstPtr& cloud)
      : pcl::search::Search<pcl::PointXYZ>("prepared", true) {
    input_ = cloud;
  }

  struct List {
    pcl::Indices places;
    std::vector<float> squared_distances;
  };

  // The search sorts by distance, then place: PCL breaks ties of the frame's signs by the points in
  // the middle of the list.
  void prepare(const CellGrid& grid, std::span<const std::uint32_t> places, float radius_m) {
    lists_.resize(places.size());
    places_.assign(places.begin(), places.end());
    for (std::size_t i = 0; i < places.size(); ++i) {
      grid.within(grid.point(places[i]), radius_m, found_);
      std::sort(found_.begin(), found_.end(), [](const auto& a, const auto& b) {
        return a.squared_distance_m2 != b.squared_distance_m2
                   ? a.squared_distance_m2 < b.squared_distance_m2
                   : a.place < b.place;
      });
      lists_[i].places.clear();
      lists_[i].squared_distances.clear();
      for (const CellGrid::Found& f : found_) {
        lists_[i].places.push_back(static_cast<pcl::index_t>(f.place));
        lists_[i].squared_distances.push_back(f.squared_distance_m2);
      }
    }
  }

  std::size_t neighbours(std::size_t i) const { return lists_[i].places.size(); }

  int radiusSearch(const PointCloud&,
                   pcl::index_t index,
                   double,
                   pcl::Indices& indices,
                   std::vector<float>& squared_distances,
                   unsigned int) const override {
    const auto it = std::find(places_.begin(), places_.end(), static_cast<std::uint32_t>(index));
    if (it == places_.end()) return 0;
    const List& list = lists_[static_cast<std::size_t>(it - places_.begin())];
    indices = list.places;
    squared_distances = list.squared_distances;
    return static_cast<int>(indices.size());
  }

  // The searches that SHOT does not use.
  int radiusSearch(const pcl::PointXYZ&,
                   double,
                   pcl::Indices&,
                   std::vector<float>&,
                   unsigned int) const override {
    throw Error(ErrorCode::kInternal, "SHOT asked for a search by position");
  }
  int nearestKSearch(const pcl::PointXYZ&, int, pcl::Indices&, std::vector<float>&) const override {
    throw Error(ErrorCode::kInternal, "SHOT asked for a search by count");
  }
  using pcl::search::Search<pcl::PointXYZ>::radiusSearch;
  using pcl::search::Search<pcl::PointXYZ>::nearestKSearch;

 private:
  std::vector<std::uint32_t> places_;
  std::vector<List> lists_;
  std::vector<CellGrid::Found> found_;
};

// PCL's axes are orthonormal to float rounding, the y axis a product of the others; made exact in
// double, z kept.
bool to_rotation(const pcl::ReferenceFrame& frame, Eigen::Matrix3f& R) {
  const Eigen::Vector3d x_axis =
      Eigen::Vector3f(frame.x_axis[0], frame.x_axis[1], frame.x_axis[2]).cast<double>();
  const Eigen::Vector3d z_axis =
      Eigen::Vector3f(frame.z_axis[0], frame.z_axis[1], frame.z_axis[2]).cast<double>();
  if (!x_axis.allFinite() || !z_axis.allFinite()) return false;
  const Eigen::Vector3d z = z_axis.normalized();
  const Eigen::Vector3d x = (x_axis - z * z.dot(x_axis)).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  R = axes.cast<float>();
  return R.allFinite() && axes.determinant() > 0.5;
}

class PclShot : public ShotDescriber {
 public:
  PclShot(const CellGrid& grid, std::span<const Eigen::Vector3f> normals, float radius_m)
      : grid_(grid), radius_m_(radius_m) {
    points_->reserve(grid.size());
    normals_->reserve(grid.size());
    for (std::size_t place = 0; place < grid.size(); ++place) {
      const Eigen::Vector3f p = grid.point(place);
      const Eigen::Vector3f& n = normals[grid.order()[place]];
      points_->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
      normals_->push_back(pcl::Normal(n.x(), n.y(), n.z()));
    }
  }

  void describe(std::span<const std::uint32_t> places,
                std::span<ShotRow> rows,
                std::span<float* const> values) const override;

 private:
  const CellGrid& grid_;
  float radius_m_;
  Points::Ptr points_ = std::make_shared<Points>();
  Normals::Ptr normals_ = std::make_shared<Normals>();
};

void PclShot::describe(std::span<const std::uint32_t> places,
                       std::span<ShotRow> rows,
                       std::span<float* const> values) const {
  const auto search = std::make_shared<PreparedSearch>(points_);
  search->prepare(grid_, places, radius_m_);

  // Only keypoints with neighbours are shown to PCL: it prints a warning for each of the others.
  const auto asked = std::make_shared<pcl::Indices>();
  std::vector<std::size_t> asked_row;
  for (std::size_t i = 0; i < places.size(); ++i) {
    rows[i].valid = false;
    if (search->neighbours(i) <= kMinNeighbours) continue;
    asked->push_back(static_cast<pcl::index_t>(places[i]));
    asked_row.push_back(i);
  }
  if (asked->empty()) return;

  pcl::SHOTLocalReferenceFrameEstimation<pcl::PointXYZ, pcl::ReferenceFrame> frame_estimator;
  frame_estimator.setInputCloud(points_);
  frame_estimator.setIndices(asked);
  frame_estimator.setSearchMethod(search);
  frame_estimator.setRadiusSearch(radius_m_);
  Frames all_frames;
  frame_estimator.compute(all_frames);

  const auto described = std::make_shared<pcl::Indices>();
  const auto frames = std::make_shared<Frames>();
  std::vector<std::size_t> described_row;
  for (std::size_t i = 0; i < asked_row.size() && i < all_frames.size(); ++i) {
    if (!to_rotation(all_frames[i], rows[asked_row[i]].frame)) continue;
    described->push_back((*asked)[i]);
    frames->push_back(all_frames[i]);
    described_row.push_back(asked_row[i]);
  }
  if (described->empty()) return;

  pcl::SHOTEstimation<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> shot;
  shot.setInputCloud(points_);
  shot.setInputNormals(normals_);
  shot.setIndices(described);
  shot.setSearchMethod(search);
  shot.setRadiusSearch(radius_m_);
  shot.setInputReferenceFrames(frames);
  pcl::PointCloud<pcl::SHOT352> histograms;
  shot.compute(histograms);

  for (std::size_t i = 0; i < described_row.size() && i < histograms.size(); ++i) {
    const auto& histogram = histograms[i].descriptor;
    rows[described_row[i]].valid = std::all_of(
        std::begin(histogram), std::end(histogram), [](float v) { return std::isfinite(v); });
    if (rows[described_row[i]].valid) {
      std::copy(std::begin(histogram), std::end(histogram), values[described_row[i]]);
    }
  }
}

}  // namespace

std::unique_ptr<ShotDescriber> make_pcl_shot(const CellGrid& grid,
                                             std::span<const Eigen::Vector3f> normals,
                                             float radius_m) {
  return std::make_unique<PclShot>(grid, normals, radius_m);
}

}  // namespace landmarkdb
