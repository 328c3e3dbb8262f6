#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/types/correspondence.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// Which way is up in both frames (unit vectors). Proposals that tilt further than the tolerance are
// dropped, the others are turned about their keypoint until the two agree.
struct Gravity {
  Eigen::Vector3f up_target = Eigen::Vector3f::UnitZ();
  Eigen::Vector3f up_source = Eigen::Vector3f::UnitZ();
  float min_cosine =
      0.9397F;  // 20 deg: what a local reference frame is off by at most, when it is right
};

// Where the sensor is expected: `centre` in the target frame, for what is `sensor_source` in the
// source's.
struct PositionPrior {
  Eigen::Vector3f sensor_source = Eigen::Vector3f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius_m = 0.0F;
};

// The correspondence of what none has proposed.
inline constexpr std::uint32_t kNoCorrespondence = ~std::uint32_t{0};

// A pose to be tested, and the correspondence that proposed it.
struct Proposal {
  Eigen::Matrix3f R_target_source = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t_target_source = Eigen::Vector3f::Zero();
  std::uint32_t correspondence = 0;
};

// The rotation, turned until the two ups agree; nullopt where it tilts further than the tolerance.
std::optional<Eigen::Matrix3f> made_upright(const Eigen::Matrix3f& R_target_source,
                                            const Gravity& gravity);

// Whether the proposal puts the sensor where it is expected.
bool is_within(const PositionPrior& prior, const Proposal& proposal);

// One proposal a correspondence: the rigid motion that lays the source keypoint's local reference
// frame onto the target keypoint's, R = F_target F_source^T. `query` indices name `source`,
// `target` ones `target`.
std::vector<Proposal> propose_from_frames(std::span<const Correspondence> correspondences,
                                          const DescriptorSet& target,
                                          const DescriptorSet& source,
                                          const std::optional<Gravity>& gravity,
                                          const std::optional<PositionPrior>& prior);

}  // namespace landmarkdb
