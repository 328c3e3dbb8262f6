#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/types/model_summary.hpp"
#include "engine/types/mono_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb::client {

// A feature point found by someone else; pixels of the image, lens distortion still in it.
struct ImagePoint {
  FeatureType type = FeatureType::kVertex;
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  std::vector<double> directions_rad{};  // of the edges that meet in it, pointing away
};

// What to look at: an image file's bytes (PNG, JPEG, PGM), or points where `image` is empty.
struct RecognizeInput {
  Camera camera;
  std::string image{};
  std::vector<ImagePoint> points{};
  std::vector<std::array<std::uint32_t, 2>> links{};  // pairs of points that one edge joins
  bool want_overlay = false;                          // a picture of the answer; of images only
};

struct RecognizeAnswer {
  RecognizeResult result;
  std::string overlay_png{};  // where asked for
};

// A model as the server knows it.
struct ModelInfo {
  ModelSummary summary;
  std::string json{};     // only of Client::model(): the model as a model file
  bool replaced = false;  // only of Client::add_model()
};

// A model file to be stored.
struct ModelAdd {
  std::string name;
  std::string file;       // its bytes
  std::string file_name;  // without folders
  std::string units;      // "m", "mm", "cm", "inch"; empty: what the file says
};

}  // namespace landmarkdb::client
