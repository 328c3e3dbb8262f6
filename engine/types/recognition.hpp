#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/stage_timings.hpp"

namespace landmarkdb {

// A model's point and the image feature it was matched with.
struct MonoPair {
  std::uint32_t model = 0;   // index into the model's points
  std::uint32_t image = 0;   // index into the image's feature points
  double residual_px = 0.0;  // distance in the image, lens distortion included
};

// How a model's edges at a pose lie on the image's, beyond how much of them does. Chance agreement
// comes in pieces, with the bright side now left, now right, on lines that go straight on past the
// model's corners; and a thing's corners are a little off its model's.
struct EdgeEvidence {
  double overrun = 0.0;    // share of the edges' ends past which the image's edge goes straight on
  double supported = 0.0;  // share of the visible length that lies on one line of the image an edge
  double lined = 0.0;      // how many edges do on four fifths of their visible length
  double bend = 0.0;  // mean square of how far the edges' ends had to move, by what is expected
};

// One model at one pose in the image.
struct MonoHypothesis {
  std::string model;
  double confidence = 0.0;  // calibrated: share of such answers that are right
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  // of (x, y, z, rx,
                                            // ry, rz), camera frame, m and rad
  std::size_t model_points = 0;             // of the model, all of them
  std::size_t visible_points = 0;           // of them, those to be seen from there
  double rms_px = 0.0;
  double log10_nfa = 0.0;   // number of false alarms (Moisan & Stival 2004)
  double edge_share = 0.0;  // of the visible edges' length, what lies on edges of the image
  double margin = 0.0;      // to the best rival: another model, or another pose of this one
  EdgeEvidence edges{};
  double shape_odds = 0.0;  // log10, positive for the model: its proportions against others
  double face_odds = 0.0;   // the same of the places of its faces
  std::string symmetry = "none";
  bool ambiguous = false;  // a second pose of a plane explains the points about as well
  std::vector<MonoPair> pairs{};
};

struct RecognizeOptions {
  std::vector<std::string> models{};  // names; empty: all
  std::size_t top = 3;
  double min_confidence = 0.5;
  double min_depth_m = 0.05;  // of the object's origin, along the optical axis
  double max_depth_m = 20.0;
  std::uint64_t seed = 1;  // given back in the result; nothing is drawn at random
};

// Wall time of each stage; the names are those of the answer's `timing_ms`.
struct RecognizeTimings {
  StageTimings::Duration features{}, lookup{}, verify{}, refine{}, total{};
};

enum class RecognizeStatus { kRecognized, kNotFound };

struct RecognizeResult {
  RecognizeStatus status = RecognizeStatus::kNotFound;
  std::string reason{};                      // only for kNotFound: which stage had nothing left
  std::vector<MonoHypothesis> hypotheses{};  // best first, at most `top`
  std::size_t image_points = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> warnings{};
  RecognizeTimings timings{};
};

}  // namespace landmarkdb
