#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/base/lazy.hpp"
#include "engine/base/run_context.hpp"
#include "engine/geometry/packed_rotation.hpp"
#include "engine/registration/plane_layout.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/scanned_space.hpp"
#include "engine/registration/sight_surface.hpp"
#include "engine/registration/surface_grid.hpp"
#include "engine/retrieval/place_outline.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// One catalogue entry with what the search derives from it, some of it only when it is asked for.
// Immutable, thread-safe.
struct Entry {
  CatalogEntry stored;
  SurfaceGrid grid;
  SurfaceGrid wide;                                  // of places: the same surface in larger cells
  SightSurface wide_sight;                           // of its surfels
  Lazy<std::vector<PlaneLayout>> planes;             // of places that have a frame of right angles
  TestPoints test;                                   // of the entry's own surface, for objects
  ScannedSpace scanned;                              // of places scanned from known viewpoints
  std::vector<PackedRotation> frames;                // of places: the keypoints' local frames
  Lazy<SightSurface, int> sight;                     // of the whole surface; by so many threads
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // mean of the points
  double extent_m = 0.0;                             // twice the root mean square distance from it

  const SceneRecord& record() const { return *stored.record; }
  bool is_object() const { return stored.record->kind == EntryKind::kObject; }
};

// The grid every surface is verified on: its cell is the working resolution, its reach what a
// proposal from one local reference frame may be off by.
SurfaceGrid make_grid(const PreparedCloud& cloud, const RunContext& context = {});
// What the grid of points at this resolution takes; throws where it would take too much.
GridSize grid_size(std::span<const Eigen::Vector3f> points,
                   double voxel_m,
                   const RunContext& context);

// Bins in which the planes of a place and of a query for it are counted, of a working resolution.
double plane_bin_m(double voxel_m);

// The grid on which a proposal is first tested, in cells a few times as large.
SurfaceGrid make_wide_grid(const PreparedCloud& cloud, const RunContext& context = {});

// Throws what make_grid does, naming the scene, and what `context.check` does.
Entry make_entry(CatalogEntry stored, const RunContext& context = {});

// An entry of which no surface but this is in memory: its grid has the cells it will have, its
// record no points, and its wide grid and keypoints are those of the outline.
Entry make_outline(CatalogEntry stored, PlaceOutline outline = {});

// Every n-th point, so that about `count` are left; points of a thinned cloud lie evenly on the
// surface.
std::vector<std::uint32_t> spread(std::size_t size, std::size_t count);

}  // namespace landmarkdb
