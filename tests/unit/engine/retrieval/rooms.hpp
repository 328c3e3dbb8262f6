#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/localizer.hpp"
#include "engine/types/query.hpp"
#include "engine/types/scene_record.hpp"
#include "tests/support/make_scene.hpp"

namespace landmarkdb::testing {

// A furnished room scanned with few points: indexed in a fraction of a second.
SyntheticScene small_room(std::uint64_t seed);

// A frame taken in the room, and where.
struct Frame {
  PointCloud cloud;
  Eigen::Isometry3d T_scene_sensor = Eigen::Isometry3d::Identity();
  Eigen::Vector3d up_sensor = Eigen::Vector3d::UnitZ();
};
Frame frame_in(const SyntheticScene& scene, std::uint64_t seed);

// The cloud described as one scan. The default options know which way is up.
SceneRecord describe(const std::string& name, PointCloud cloud, const IndexOptions& options);
SceneRecord describe_room(const std::string& name, const SyntheticScene& scene);

// A catalogue of these, in this order, and what searches it.
std::unique_ptr<Localizer> localizer_of(std::vector<SceneRecord> records);

// The cloud, moved: its points, normals and viewpoints become T * p.
PointCloud moved(PointCloud cloud, const Eigen::Isometry3d& T);

}  // namespace landmarkdb::testing
