#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/triangle_mesh.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

// Things that are stored whole and looked for in cluttered scenes.
namespace landmarkdb::datasets {

enum class ObjectKind {
  kFigurine,
  kAnimal,
  kCarton,      // a plain box: half turns about three axes change nothing
  kMilkCarton,  // with a gable and a cap, which alone tells a half turn
  kBottle,      // turned on a lathe
  kSprayBottle,
  kMug,
  kTool,
  kTrain,
  kChair,
  kPlant,
  kStatue,
  kBin,
  kVending,
};

// Kinds that stand on a table (5 to 40 cm), and on the floor (0.4 to 2 m).
std::span<const ObjectKind> table_objects();
std::span<const ObjectKind> floor_objects();
std::string_view object_kind_name(ObjectKind kind);

struct ObjectOptions {
  ObjectKind kind = ObjectKind::kFigurine;
  std::uint64_t seed = 1;  // same options, same object, bit for bit
  // Another number: a look-alike, the same thing 8 to 25 % longer or shorter along each axis.
  std::uint64_t twin = 0;
};

// Metres; z up, the origin on the foot, in its middle.
struct ObjectModel {
  std::string name;
  ObjectOptions options;
  TriangleMesh mesh;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the bounding box
  double extent_m = 0.0;                             // its diagonal
  // Motions of the object onto itself but the identity; with `revolution` any turn about z is one
  // as well.
  std::vector<Eigen::Isometry3d> symmetries;
  bool revolution = false;
};

ObjectModel make_object(const ObjectOptions& options);

// How far an estimated pose of the object is from the true one: the distance of the centres, and
// the angle between, both as they are and up to the object's discrete symmetries. A turn about an
// axis of revolution never counts.
struct ObjectError {
  double metres = 0.0;
  double degrees = 0.0;
  double symmetric_metres = 0.0;
  double symmetric_degrees = 0.0;
};
ObjectError object_error(const ObjectModel& model,
                         const Eigen::Isometry3d& T_scene_object,
                         const Eigen::Isometry3d& estimate);

// From where a model is scanned.
enum class ObjectViews {
  kAround,     // turned over in the hand: all sides
  kTurntable,  // all but the underside
  kFront,      // 130 degrees of it: an open surface
};

struct ObjectScanOptions {
  ObjectViews views = ObjectViews::kAround;
  double spacing_m = 0.0;       // between points of one view; 0: a hundredth of the extent
  double noise_m = 0.0005;      // standard deviation along the ray
  bool keep_viewpoints = true;  // false: as models are passed on, without where they were seen from
  std::uint64_t seed = 1;
};

// The scan of the object in its own frame. Same options, same points for any number of threads.
PointCloud scan_object(const ObjectModel& model,
                       const ObjectScanOptions& options,
                       const RunContext& context);

}  // namespace landmarkdb::datasets
