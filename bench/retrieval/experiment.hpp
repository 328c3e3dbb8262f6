#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::bench {

// One of the two experiments of the paper (Cocias et al. 2014), at its size, on a generated place.
struct ExperimentOptions {
  std::string name = "temple";
  datasets::PlaceType type = datasets::PlaceType::kTemple;
  std::size_t points = 0;        // of the scan, exactly
  std::size_t query_points = 0;  // of each frame, exactly; 0: all
  int frames = 10;
  std::uint64_t seed = 10'000;  // of place, scan, camera poses and noise
};

// The temple chamber and the lobby, with the paper's numbers of points.
ExperimentOptions temple_experiment();
ExperimentOptions lobby_experiment();

// A depth frame with the truth about it, and the part of its points that is asked with.
struct Frame {
  datasets::DepthFrame full;
  PointCloud query;
};

struct Experiment {
  ExperimentOptions options;
  datasets::Place place;
  PointCloud scan;  // scene frame, viewpoints known
  std::vector<Frame> frames;
};

// Scans the place and takes the frames. A frame with fewer valid pixels than are asked for is
// passed over and the next pose taken. Same options, same experiment. Throws what the generator
// throws.
Experiment make_experiment(const ExperimentOptions& options, const RunContext& context);

// The place of the experiment, described with these keypoints, as a catalogue of one.
std::shared_ptr<const Catalog> index_experiment(const Experiment& experiment,
                                                KeypointMethod keypoints,
                                                const RunContext& context);

}  // namespace landmarkdb::bench
