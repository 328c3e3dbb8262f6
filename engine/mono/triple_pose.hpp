#pragma once

#include <array>

#include <Eigen/Core>

#include "engine/mono/rigid_pose.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// Works out what ModelTriple keeps of its three points: sides, axes, centroid, inverse, smallest
// sine. False, and the triple as it was, where they coincide or are collinear (|e1 x e2| below a
// thousandth of the longest side squared) or not finite: such a triple has no pose.
bool complete_triple(const std::array<Eigen::Vector3d, 3>& points_m, ModelTriple& triple);

// The poses of a triple under weak perspective.
struct TriplePoses {
  PoseStatus status = PoseStatus::kNotFinite;
  int count = 0;            // 0, 1 (seen square on) or 2
  double depth_m = 0.0;     // of the centroid, along the line of sight
  double cos_tilt = 0.0;    // of the triangle's plane against the image
  bool from_front = false;  // the normal n points towards the camera
  std::array<RigidPose, 2> poses;
};

// The closed form: the plane-to-image map's larger singular value is the inverse depth, and the
// sign of the tilt is all that stays open (Alter 1994; Huttenlocher and Ullman 1990).
//
// `rays`: x, y at z = 1 of the three points, lens distortion removed, in the triple's order. The
// object must lie near the optical axis; solve_triple_in_sight is for any place. kCollinearImage
// with count 0: the rays coincide; with count 2: they are collinear, the poses are no basis for a
// hypothesis. No allocation. Cost: some 50 ns.
TriplePoses solve_triple(const ModelTriple& triple, const std::array<Eigen::Vector2d, 3>& rays);

// The same after turning the camera towards the triple, which takes the error of weak perspective
// from the angle to the optical axis down to the object's own depth.
TriplePoses solve_triple_in_sight(const ModelTriple& triple,
                                  const std::array<Eigen::Vector2d, 3>& rays);

// Carries a pose of solve_triple_in_sight towards full perspective: `rounds` times the rays are
// scaled by their points' depths and the triple is solved again, staying on the branch of `pose`.
RigidPose correct_perspective(const ModelTriple& triple,
                              const std::array<Eigen::Vector3d, 3>& points_m,
                              const std::array<Eigen::Vector2d, 3>& rays,
                              const RigidPose& pose,
                              int rounds);

}  // namespace landmarkdb
