#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "bench/mono/recognition.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/types/grey_image.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb::bench {

struct PictureOptions {
  std::size_t models = 12;     // in the catalogue
  std::size_t pictures = 200;  // every other one without an object of the catalogue
  std::uint64_t seed = 1;
};

// A rendered picture; `shown` is the catalogue's model in it, -1 where there is none of them.
struct Picture {
  GreyImage image;
  Camera camera;
  int shown = -1;
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
};

// Boxes, prisms with steps, gables and wedges, some with discs on them, and every fourth a convex
// body of triangles: 0.08 to 0.25 m across, the same for the same seed.
std::shared_ptr<const MonoCatalog> make_picture_catalog(std::uint64_t seed, std::size_t count);

// A picture (640 x 480) of a model of the catalogue, or of one that is in none, among up to five
// bodies that are in none and may stand before it, up to 30 flat shapes, uneven light and noise.
// The object differs from its model by up to 1 % of its size (sigma), the camera from its
// calibration by up to 0.5 % of the focal length.
Picture make_picture(const MonoCatalog& catalog, bool known, std::uint64_t seed);
// Picture `number` of those that options speak of.
Picture make_picture(const MonoCatalog& catalog, const PictureOptions& options, std::size_t number);

// Whether a pose is the true one of a model, within 5 degrees and a twentieth of its distance, but
// for the model's symmetries.
bool is_right_pose(const MonoModel& model,
                   const Eigen::Isometry3d& found,
                   const Eigen::Isometry3d& truth);

// One hypothesis about a picture.
struct PictureHypothesis {
  std::size_t picture = 0;
  bool known = false;  // the picture has an object of the catalogue
  bool right = false;
  double confidence = 0.0;
  double length_px = 0.0;  // of the edges that the pose shows
  RecognitionEvidence evidence{};
};

struct PictureOutcomes {
  std::vector<Outcome> best;            // the best hypothesis of each picture
  std::vector<PictureHypothesis> told;  // all hypotheses, by picture and best first
};

// What the recogniser says of them. Right: the model, and is_right_pose.
PictureOutcomes run_pictures(const PictureOptions& options);

}  // namespace landmarkdb::bench
