#pragma once

#include <string>
#include <vector>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/grey_image.hpp"
#include "engine/types/mono_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// A model at the pose at which it was found; both must outlive the drawing.
struct OverlayModel {
  const MonoModel* model = nullptr;
  const MonoHypothesis* hypothesis = nullptr;
};

// The image with what was recognised drawn on it, as the bytes of a PNG file of the same size
// (8-bit RGB). Of each model: its edges and circles as far as faces do not hide them, through the
// lens model, green for the best hypothesis and blue for the others; of the best the matched points
// as green rings round the image's features, the seen but unmatched ones as red crosses. The
// image's features are small yellow rings.
std::string draw_overlay(const GreyImage& image,
                         const ImageFeatures& features,
                         const Camera& camera,
                         const std::vector<OverlayModel>& models);

}  // namespace landmarkdb
