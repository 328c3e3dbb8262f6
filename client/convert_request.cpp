#include <bit>
#include <cstddef>
#include <cstring>
#include <string>

#include <zstd.h>

#include "client/convert.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

// Fastest level: float noise hardly packs, and a loopback is quicker than a better level.
constexpr int kZstdLevel = 1;

static_assert(std::endian::native == std::endian::little, "points travel little-endian");
static_assert(sizeof(Eigen::Vector3f) == 12, "points travel as three packed floats");

void put(v1::Vector3* out, const Eigen::Vector3d& v) {
  out->set_x(v.x());
  out->set_y(v.y());
  out->set_z(v.z());
}

template <typename Repeated>
void put_pose(Repeated* out, const Eigen::Isometry3d& T) {
  for (const double number : to_row_major(T.matrix())) out->Add(number);
}

std::string packed(const PointCloud& cloud) {
  std::string bytes(cloud.points.size() * sizeof(Eigen::Vector3f), '\0');
  if (!bytes.empty()) std::memcpy(bytes.data(), cloud.points.data(), bytes.size());
  return bytes;
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) {
    throw Error(ErrorCode::kInternal, std::string("zstd: ") + ZSTD_getErrorName(size));
  }
  out.resize(size);
  return out;
}

v1::KeypointMethod to_proto(KeypointMethod method) {
  switch (method) {
    case KeypointMethod::kUniform:
      return v1::KEYPOINT_METHOD_UNIFORM;
    case KeypointMethod::kStructure:
      return v1::KEYPOINT_METHOD_STRUCTURE;
    case KeypointMethod::kIss:
      return v1::KEYPOINT_METHOD_ISS;
    case KeypointMethod::kNarf:
      return v1::KEYPOINT_METHOD_NARF;
  }
  return v1::KEYPOINT_METHOD_UNSPECIFIED;
}

v1::Measure to_proto(Measure measure) {
  switch (measure) {
    case Measure::kL2:
      return v1::MEASURE_L2;
    case Measure::kL1:
      return v1::MEASURE_L1;
    case Measure::kChi2:
      return v1::MEASURE_CHI2;
    case Measure::kIntersection:
      return v1::MEASURE_INTERSECTION;
    case Measure::kCorrelation:
      return v1::MEASURE_CORRELATION;
    case Measure::kBhattacharyya:
      return v1::MEASURE_BHATTACHARYYA;
  }
  return v1::MEASURE_UNSPECIFIED;
}

v1::Filter to_proto(Filter filter) {
  switch (filter) {
    case Filter::kRatio:
      return v1::FILTER_RATIO;
    case Filter::kSlope:
      return v1::FILTER_SLOPE;
    case Filter::kClique:
      return v1::FILTER_CLIQUE;
  }
  return v1::FILTER_UNSPECIFIED;
}

}  // namespace

v1::Cloud to_proto(const PointCloud& cloud, const CloudEncoding& encoding) {
  v1::Cloud out;
  out.set_encoding(v1::POINT_ENCODING_FLOAT32);
  out.set_points(cloud.size());
  out.set_zstd(encoding.zstd);
  out.set_xyz(encoding.zstd ? compressed(packed(cloud)) : packed(cloud));
  out.set_width(cloud.width);
  out.set_height(cloud.height);
  if (!cloud.viewpoints.empty()) {
    put(out.mutable_viewpoint(), cloud.viewpoints.front().cast<double>());
  }
  if (!cloud.origin.isZero(0.0)) put(out.mutable_origin_m(), cloud.origin);
  return out;
}

void add_to_proto(const QueryCloud& cloud, const CloudEncoding& encoding, v1::QueryRequest& out) {
  *out.add_clouds() = to_proto(cloud.cloud, encoding);
  put_pose(out.mutable_t_query_clouds(), cloud.T_query_cloud);
}

v1::QueryOptions to_proto(const QueryOptions& options) {
  v1::QueryOptions out;
  out.set_profile(options.profile == Profile::kPaper ? v1::PROFILE_PAPER : v1::PROFILE_ROBUST);
  for (const std::string& scene : options.scenes) out.add_scenes(scene);
  out.set_top(options.top);
  out.set_min_confidence(options.min_confidence);
  if (options.up) put(out.mutable_up(), *options.up);
  if (options.prior_T_scene_sensor) {
    put_pose(out.mutable_prior_t_scene_sensor(), *options.prior_T_scene_sensor);
    out.set_prior_radius_m(options.prior_radius_m);
  }
  if (options.keypoints) out.set_keypoints(to_proto(*options.keypoints));
  out.set_measure(to_proto(options.measure));
  out.set_search(options.search == Search::kFlann ? v1::SEARCH_FLANN : v1::SEARCH_EXACT);
  out.set_ratio(options.ratio);
  for (const Filter filter : options.filters) out.add_filters(to_proto(filter));
  out.set_solver(options.solver == Solver::kPnp ? v1::SOLVER_PNP : v1::SOLVER_SIMILARITY);
  out.set_estimate_scale(options.estimate_scale);
  out.set_seed(options.seed);
  out.set_want_correspondences(options.want_correspondences);
  out.set_explain(options.explain);
  out.set_want_scene_points(options.want_scene_points);
  return out;
}

v1::SceneAddRequest to_proto(const SceneAdd& add, const CloudEncoding& encoding) {
  v1::SceneAddRequest out;
  out.set_name(add.name);
  for (const SceneScan& scan : add.scans) {
    v1::SceneAddScan& one = *out.add_scans();
    *one.mutable_cloud() = to_proto(scan.cloud, encoding);
    put_pose(one.mutable_t_scene_cloud(), scan.T_scene_cloud);
    one.set_source(scan.source);
  }
  out.set_kind(add.kind == EntryKind::kObject ? v1::ENTRY_KIND_OBJECT : v1::ENTRY_KIND_PLACE);
  if (add.voxel_m) out.set_voxel_m(*add.voxel_m);
  if (add.radius_m) out.set_radius_m(*add.radius_m);
  if (add.keypoints) out.set_keypoints(to_proto(*add.keypoints));
  if (add.up) put(out.mutable_up(), *add.up);
  return out;
}

v1::Landmark to_proto(const Landmark& landmark) {
  v1::Landmark out;
  out.set_name(landmark.name);
  put(out.mutable_min_m(), landmark.min_m);
  put(out.mutable_max_m(), landmark.max_m);
  return out;
}

}  // namespace landmarkdb::client
