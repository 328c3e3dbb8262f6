#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// What a feature point is, on the model and in the image. Only equal types match.
enum class FeatureType : std::uint8_t {
  kVertex = 0,
  kConicCentre = 1,
  kCentroid = 2,
  kInflexion = 3
};
inline constexpr std::size_t kFeatureTypes = 4;

struct ModelFeature {
  FeatureType type = FeatureType::kVertex;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // metres, object frame
  std::optional<Eigen::Vector3d> normal{};        // unit; none: seen from everywhere
  std::int32_t part = -1;  // the circle of a kConicCentre, the face of a kCentroid; -1: none
};

struct ModelCircle {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // metres, object frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double radius_m = 0.0;
};

// A rigid object that is recognised in one image. Metres, object frame; indices are into `points`.
struct MonoModel {
  std::string name;
  std::string source{};     // the file it came from, without folders
  double unit_scale = 1.0;  // metres a unit of that file
  std::vector<ModelFeature> points{};
  std::vector<std::array<std::uint32_t, 2>> edges{};
  std::vector<ModelCircle> circles{};
  std::vector<std::vector<std::uint32_t>> faces{};  // outward, counter-clockwise
  std::vector<Eigen::Matrix4d> symmetries{};        // rigid motions onto itself; identity first
  std::string symmetry_class = "none";              // "c2", "c4", "cube", "revolution", ...
  double diameter_m = 0.0;                          // largest distance of two points
};

// The 256 directions of the Fibonacci sphere a model is looked at from.
inline constexpr std::size_t kModelViews = 256;
using ViewMask = std::bitset<kModelViews>;

// An ordered triple of feature points with what its weak-perspective pose needs, worked out once.
//
// Points i0 (the junction), i1 < i2. u, v, n: right-handed axes of the triangle's plane, object
// frame; `centroid` of the three points; `inverse`: i00, i01, i11 of the upper triangular inverse
// of [[e1.u, e2.u], [0, e2.v]], with e1 = P1 - P0 and e2 = P2 - P0 (1/m).
struct ModelTriple {
  std::array<std::uint32_t, 3> points{};
  std::uint32_t type_signature = 0;   // 2 bits a point, i0 lowest
  std::uint8_t links = 0;             // of the three pairs, how many share an edge
  std::int32_t face = -1;             // the face all three lie on; -1: none
  std::array<double, 3> lengths_m{};  // |P0P1|, |P0P2|, |P1P2|
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  std::array<double, 3> inverse{};
  ViewMask views{};      // from where all three are seen
  double min_sin = 0.0;  // smallest sine of the triangle's angles
};

// A search index of one model, derived from it: may be deleted, and is then made anew.
struct ModelIndexBlob {
  std::int64_t version = 0;  // of its layout, whoever writes it
  std::string params{};      // what it was made with, free text
  std::vector<std::byte> quads{};

  bool is_made_like(const ModelIndexBlob& other) const {
    return version == other.version && params == other.params;
  }
};

// One model as stored and as searched.
struct MonoModelRecord {
  MonoModel model;
  std::vector<ModelTriple> triples{};
  std::optional<ModelIndexBlob> index{};  // none: made when it is needed
};

struct MonoCatalogEntry {
  std::int64_t model_id = 0;
  std::shared_ptr<const MonoModelRecord> record;
  std::string sha256{};  // of what the store holds; empty where it is not from a store
};

// All models at one moment. Never changes once built; shared between requests.
struct MonoCatalog {
  std::uint64_t generation = 0;
  std::vector<MonoCatalogEntry> entries;  // by model_id, ascending
};

}  // namespace landmarkdb
