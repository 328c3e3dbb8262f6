#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <apriltag/apriltag.h>
#include <apriltag/apriltag_pose.h>
#include <apriltag/tag36h11.h>

#include "bench/retrieval/marker.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {

namespace {

constexpr int kNumber = 0;

using Family = std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)>;
using Detector = std::unique_ptr<apriltag_detector_t, decltype(&apriltag_detector_destroy)>;
using Detections = std::unique_ptr<zarray_t, decltype(&apriltag_detections_destroy)>;
using Image = std::unique_ptr<image_u8_t, decltype(&image_u8_destroy)>;
// Debian's library keeps matd_get and matd_destroy to itself; a matrix is one block of calloc.
using Matrix = std::unique_ptr<matd_t, decltype(&std::free)>;

Eigen::Isometry3d pose_of(apriltag_detection_t* detection, const Camera& camera, double size_m) {
  apriltag_detection_info_t info{};
  info.det = detection;
  info.tagsize = size_m;
  info.fx = camera.fx;
  info.fy = camera.fy;
  info.cx = camera.cx + 0.5;  // AprilTag's pixels begin at their corner
  info.cy = camera.cy + 0.5;
  apriltag_pose_t pose{};
  estimate_tag_pose(&info, &pose);
  const Matrix R(pose.R, std::free);
  const Matrix t(pose.t, std::free);
  Eigen::Matrix3d rotation;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned column = 0; column < 3; ++column) {
      rotation(row, column) = MATD_EL(R.get(), row, column);
    }
    T.translation()(row) = MATD_EL(t.get(), row, 0);
  }
  T.linear() = nearest_rotation(rotation);
  return T;
}

}  // namespace

std::string marker_name() { return "AprilTag 36h11"; }

std::optional<MarkerPattern> marker_pattern() {
  const Family family(tag36h11_create(), tag36h11_destroy);
  const Image image(apriltag_to_image(family.get(), kNumber), image_u8_destroy);
  MarkerPattern pattern;
  pattern.cells = image->width;
  pattern.border_cells = family->width_at_border;
  for (int row = 0; row < image->height; ++row) {
    const auto* begin = image->buf + static_cast<std::ptrdiff_t>(row) * image->stride;
    pattern.values.insert(pattern.values.end(), begin, begin + image->width);
  }
  return pattern;
}

std::optional<Eigen::Isometry3d> find_marker(const GreyImage& image,
                                             const Camera& camera,
                                             double size_m) {
  const Family family(tag36h11_create(), tag36h11_destroy);
  const Detector detector(apriltag_detector_create(), apriltag_detector_destroy);
  apriltag_detector_add_family(detector.get(), family.get());
  detector->quad_decimate = 1.0F;  // full resolution: the best it can do
  const Image copy(
      image_u8_create(static_cast<unsigned>(image.width), static_cast<unsigned>(image.height)),
      image_u8_destroy);
  for (int row = 0; row < image.height; ++row) {
    std::memcpy(copy->buf + static_cast<std::ptrdiff_t>(row) * copy->stride,
                image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width,
                static_cast<std::size_t>(image.width));
  }
  const Detections found(apriltag_detector_detect(detector.get(), copy.get()),
                         apriltag_detections_destroy);
  std::optional<Eigen::Isometry3d> pose;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    if (detection->id == kNumber) pose = pose_of(detection, camera, size_m);
  }
  // The detector keeps a reference to the family, which goes before it.
  apriltag_detector_remove_family(detector.get(), family.get());
  return pose;
}

}  // namespace landmarkdb::bench
