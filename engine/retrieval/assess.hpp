#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/registration/icp.hpp"
#include "engine/registration/verify.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/query_view.hpp"

namespace landmarkdb {

// A pose of the sensor in an entry, refined, with what speaks for and against it. The entry's
// coordinates are those of its stored points (without the origin).
struct Assessed {
  std::size_t entry = 0;
  std::size_t matches = 0;  // whose correspondences proposed it (SearchResult::matches)
  Eigen::Isometry3d T_entry_proposed =
      Eigen::Isometry3d::Identity();  // sensor to entry, before refinement
  Eigen::Isometry3d T_entry_sensor = Eigen::Isometry3d::Identity();  // after
  std::size_t candidate = 0;         // its number among the candidates, 0 did best in the test
  std::uint32_t correspondence = 0;  // that proposed it, of the entry's own list
  IcpResult icp;
  Evidence evidence;
  double score = 0.0;  // 0..1, for ranking and for telling rivals
  std::size_t id = 0;  // its number among the poses that were compared
  // Against the pose of each id (see contrast_poses); empty where none were compared.
  std::vector<float> contrast;
  double closeness = 0.0;  // 0..1: how closely the points lie on the surface; 0: not measured
};

// True when the two poses are of one entry and carry what they locate to the same spot, turned
// alike: of a place the query's centre (sensor frame), of an object its own.
bool same_spot(const Assessed& a,
               const Assessed& b,
               const Entry& entry,
               const Eigen::Vector3d& query_centre,
               double translation_m,
               double rotation_rad);

// Where the query's surface and the entry's meet: for a place the query's points lie on the entry's
// surface; for an object the object's points lie on the query's.
struct Meeting {
  const SurfaceGrid& target;
  std::span<const Eigen::Vector3f> source;
  std::span<const Eigen::Vector3f> source_normals;
  bool entry_is_source = false;
  // Plane distance at which a point still lies on the surface. Entries described at different
  // resolutions compete, so the finest sets it for all.
  double tolerance_m = 0.0;
  // What the sensor saw, finer than the query's own where objects are asked for; empty: those.
  std::span<const RangeImage> ranges{};
  // Of a place: the points that the last refinement goes by (QueryView::precise_points); empty:
  // there is none.
  std::span<const Eigen::Vector3f> precise{};
  std::span<const Eigen::Vector3f> precise_normals{};
  const RangeNoise* noise = nullptr;  // of the target, where it is known
};

// A quick refinement with few points, and the sight of the entry's wide grid (of an object's whole
// surface): enough to rank candidates.
Assessed assess_coarse(const Meeting& meeting,
                       const Entry& entry,
                       const CleanQuery& query,
                       const Eigen::Isometry3d& T_entry_sensor);

// Refinement with all points, and all the evidence; of a place as far as its wide grid shows it.
void assess_fine(const Meeting& meeting,
                 const Entry& entry,
                 const CleanQuery& query,
                 Assessed& assessed);

// Of a place's pose: the evidence of all points and the whole surface.
void assess_precisely(const Meeting& meeting,
                      const Entry& entry,
                      const CleanQuery& query,
                      Assessed& assessed);

}  // namespace landmarkdb
