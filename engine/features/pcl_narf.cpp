#include "engine/features/pcl_narf.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>

#include <pcl/features/range_image_border_extractor.h>
#include <pcl/keypoints/narf_keypoint.h>
#include <pcl/point_types.h>
#include <pcl/range_image/range_image.h>

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// At 0.3 degrees a whole sphere is 1200 x 600 pixels, for which PCL needs some 100 MB.
constexpr double kFinestResolution = 0.3 * kDegree;
constexpr double kCoarsestResolution = 5.0 * kDegree;

// PCL looks angles up in tables by numbers that are NaN for a point on the sensor or so far off
// that its squared distance overflows.
constexpr float kNearest_m = 1e-3F;
constexpr float kFarthest_m = 1e6F;

// Below the rounding of a unit vector of floats, far above the square root of the smallest float.
constexpr float kLeastComponent = 1e-6F;

// Shows the detector mended directions: it asks for the scores again, and they are not computed
// twice.
class GuardedBorders : public pcl::RangeImageBorderExtractor {
 public:
  void guard(std::size_t pixels) {
    getSurfaceChangeScores();  // computes both arrays
    mend_surface_changes(std::span(surface_change_scores_, pixels),
                         std::span(surface_change_directions_, pixels));
  }
};

// The axis along which the view directions point least: the image's poles, where pixels crowd.
int pole_axis(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d direction = p.cast<double>().normalized();
    along += direction.cwiseAbs2();
  }
  int axis = 1;
  along.minCoeff(&axis);
  return axis;
}

// Turns the pole axis to PCL's y by a cyclic exchange of axes, or back.
Eigen::Vector3f exchange_axes(const Eigen::Vector3f& p, int shift) {
  return {p[shift % 3], p[(shift + 1) % 3], p[(shift + 2) % 3]};
}

// The first image of a process fills PCL's shared tables, which two threads must not do at once.
pcl::RangeImage empty_image() {
  static const pcl::RangeImage first;
  return first;
}

// Cuts the image to what was seen and one pixel around it; false where nothing was. PCL's own
// cropping takes an image without a pixel to a negative size.
bool crop_to_seen(pcl::RangeImage& image) {
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  int top = height;
  int right = -1;
  int bottom = -1;
  int left = width;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!image.isValid(x, y)) continue;
      top = std::min(top, y);
      bottom = std::max(bottom, y);
      left = std::min(left, x);
      right = std::max(right, x);
    }
  }
  if (right < 0) return false;
  image.cropImage(1, top, right, bottom, left);
  image.recalculate3DPointPositions();
  return true;
}

}  // namespace

void mend_surface_changes(std::span<float> scores, std::span<Eigen::Vector3f> directions) {
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (!std::isfinite(scores[i]) || !directions[i].allFinite()) {
      scores[i] = 0.0F;
      directions[i].setZero();
    }
    for (float& component : directions[i]) {
      if (std::abs(component) < kLeastComponent) component = 0.0F;
    }
  }
}

std::vector<Eigen::Vector3f> narf_interest_points(std::span<const Eigen::Vector3f> points,
                                                  double angular_resolution_rad,
                                                  double support_m) {
  std::vector<Eigen::Vector3f> usable;
  std::copy_if(points.begin(), points.end(), std::back_inserter(usable), [](const auto& p) {
    const float range = p.norm();
    return range >= kNearest_m && range <= kFarthest_m;
  });
  if (usable.empty()) return {};

  const int shift = (pole_axis(usable) + 2) % 3;  // the component that becomes y comes second
  pcl::PointCloud<pcl::PointXYZ> turned;
  for (const Eigen::Vector3f& p : usable) {
    const Eigen::Vector3f q = exchange_axes(p, shift);
    turned.push_back(pcl::PointXYZ(q.x(), q.y(), q.z()));
  }
  const double resolution =
      std::clamp(angular_resolution_rad, kFinestResolution, kCoarsestResolution);
  pcl::RangeImage image = empty_image();
  image.createFromPointCloud(turned,
                             static_cast<float>(resolution),
                             static_cast<float>(2.0 * std::numbers::pi),
                             static_cast<float>(std::numbers::pi),
                             Eigen::Affine3f::Identity(),
                             pcl::RangeImage::CAMERA_FRAME,
                             0.0F,                              // noise level
                             0.0F,                              // least range
                             std::numeric_limits<int>::min());  // do not crop
  if (!crop_to_seen(image)) return {};

  GuardedBorders borders;
  borders.setRangeImage(&image);
  borders.guard(image.size());
  pcl::NarfKeypoint detector(&borders, static_cast<float>(support_m));
  detector.getParameters().max_no_of_threads = 1;
  std::vector<Eigen::Vector3f> found;
  for (const auto& point : detector.getInterestPoints().points) {
    const Eigen::Vector3f p = point.getVector3fMap();
    if (p.allFinite()) found.push_back(exchange_axes(p, (3 - shift) % 3));
  }
  return found;
}

}  // namespace landmarkdb
