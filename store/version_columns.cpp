#include "store/version_columns.hpp"

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

std::int64_t rows_of(const Manifest& manifest, std::string_view array) {
  for (const ArrayInfo& info : manifest.arrays) {
    if (info.name == array) return static_cast<std::int64_t>(info.shape.front());
  }
  return 0;
}

}  // namespace

VersionColumns columns_of(const Manifest& manifest) {
  VersionColumns columns;
  columns.kind = kind_name(manifest.kind);
  columns.points = rows_of(manifest, "points");
  columns.keypoints = rows_of(manifest, "keypoints");
  columns.options = manifest.options;
  columns.up = manifest.up;
  columns.sources = texts_to_json(manifest.sources);
  columns.warnings = texts_to_json(manifest.warnings);
  return columns;
}

VersionColumns read_version_columns(const sqlite::Database& database,
                                    std::int64_t scene_id,
                                    std::int64_t version) {
  sqlite::Statement row(database,
                        "SELECT kind, points, keypoints, voxel_m, normal_radius_m, shot_radius_m, "
                        "keypoint_spacing_m, keypoint_method, up_x, up_y, up_z, sources, warnings "
                        "FROM scene_version WHERE scene_id = ? AND version = ?");
  row.bind(scene_id).bind(version);
  if (!row.step()) {
    throw Error(ErrorCode::kNotFound,
                "scene " + std::to_string(scene_id) + " has no version " + std::to_string(version));
  }
  VersionColumns columns;
  columns.kind = row.text(0);
  columns.points = row.integer(1);
  columns.keypoints = row.integer(2);
  columns.options.voxel_m = row.real(3);
  columns.options.normal_radius_m = row.real(4);
  columns.options.shot_radius_m = row.real(5);
  columns.options.keypoint_spacing_m = row.real(6);
  columns.options.keypoints =
      keypoint_method_from_name(row.text(7)).value_or(KeypointMethod::kStructure);
  if (!row.is_null(8) && !row.is_null(9) && !row.is_null(10)) {
    columns.up = Eigen::Vector3d(row.real(8), row.real(9), row.real(10));
  }
  columns.sources = row.text(11);
  columns.warnings = row.text(12);
  return columns;
}

void write_version_columns(const sqlite::Database& database,
                           std::int64_t scene_id,
                           std::int64_t version,
                           const VersionColumns& columns) {
  sqlite::Statement update(
      database,
      "UPDATE scene_version SET kind = ?, points = ?, keypoints = ?, voxel_m = ?, "
      "normal_radius_m = ?, shot_radius_m = ?, keypoint_spacing_m = ?, keypoint_method = ?, "
      "up_x = ?, up_y = ?, up_z = ?, sources = ?, warnings = ? "
      "WHERE scene_id = ? AND version = ?");
  update.bind(columns.kind)
      .bind(columns.points)
      .bind(columns.keypoints)
      .bind(columns.options.voxel_m)
      .bind(columns.options.normal_radius_m)
      .bind(columns.options.shot_radius_m)
      .bind(columns.options.keypoint_spacing_m)
      .bind(keypoint_method_name(columns.options.keypoints));
  for (int axis = 0; axis < 3; ++axis) {
    if (columns.up) {
      update.bind((*columns.up)[axis]);
    } else {
      update.bind_null();
    }
  }
  update.bind(columns.sources).bind(columns.warnings).bind(scene_id).bind(version);
  update.run();
}

}  // namespace landmarkdb
