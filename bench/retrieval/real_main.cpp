// Asks every real case and prints right, wrong or declined with its errors and evidence.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>

#include "bench/retrieval/real_cases.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/localizer.hpp"

namespace landmarkdb::bench {

namespace {

// The truth itself is only so good: a pose this right can be measured that much further away.
constexpr double kRightMetres = 0.10;
constexpr double kRightRad = 0.0873;  // 5 deg

std::shared_ptr<const Catalog> index_all(const std::vector<std::filesystem::path>& paths,
                                         EntryKind kind,
                                         const RunContext& context) {
  auto catalog = std::make_shared<Catalog>();
  for (const auto& path : paths) {
    std::vector<Scan> scans(1);
    scans[0].cloud = read_cloud(path, {});
    scans[0].source = path.filename().string();
    IndexOptions options;
    options.kind = kind;
    const auto start = std::chrono::steady_clock::now();
    auto record = std::make_shared<SceneRecord>(
        describe_scene(path.stem().string(), std::move(scans), options, context));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    std::fprintf(stderr,
                 "%-18s voxel %.4f points %zu keypoints %zu dropped %zu viewpoint %d %.2f s\n",
                 record->name.c_str(),
                 record->options.voxel_m,
                 record->prepared.size(),
                 record->descriptors.size(),
                 record->descriptors.dropped,
                 static_cast<int>(record->prepared.normals_from_viewpoint),
                 took.count());
    CatalogEntry entry;
    entry.scene_id = static_cast<std::int64_t>(catalog->entries.size()) + 1;
    entry.version = 1;
    entry.record = std::move(record);
    catalog->entries.push_back(std::move(entry));
  }
  return catalog;
}

Eigen::Vector3d mean_of(const PointCloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t n = 0;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (!p.allFinite()) continue;
    sum += p.cast<double>();
    ++n;
  }
  return sum / static_cast<double>(std::max<std::size_t>(n, 1)) + cloud.origin;
}

void ask(const RealCase& one, const Localizer& localizer, const RunContext& context) {
  const PointCloud cloud = read_cloud(one.query, {});
  const QueryResult answer = localizer.query(cloud, {}, context);
  const char* status = answer.status == QueryStatus::kLocalized   ? "localized"
                       : answer.status == QueryStatus::kAmbiguous ? "ambiguous"
                                                                  : "not_found";
  std::printf("%-22s %-10s", one.id.c_str(), status);
  const Eigen::Vector3d centre = mean_of(cloud);
  std::size_t rank = 0;
  for (const Hypothesis& h : answer.hypotheses) {
    if (rank++ > 1) break;
    double metres = -1.0;
    double degrees = -1.0;
    if (one.T_target_query && h.scene == one.targets.at(0).stem().string()) {
      const Eigen::Matrix4d truth = one.T_target_query->matrix();
      metres = ((h.T_scene_sensor - truth) * centre.homogeneous()).norm();
      degrees = rotation_angle_rad(truth.topLeftCorner<3, 3>().transpose() *
                                   h.T_scene_sensor.topLeftCorner<3, 3>()) *
                57.29578;
    }
    const bool right = metres >= 0.0 && metres < kRightMetres + one.accuracy_m &&
                       degrees < (kRightRad + one.accuracy_rad) * 57.29578;
    std::printf(
        " | %-5s %-12s %6.3f m %6.2f deg c %.2f ov %.2f ex %.2f cv %.2f cr %.3f ct %.3f rf %.3f mg "
        "%.2f ob %.4f in "
        "%u",
        right ? "RIGHT" : "wrong",
        h.scene.c_str(),
        metres,
        degrees,
        h.confidence,
        h.fit.overlap,
        h.fit.explained,
        h.fit.coverage,
        h.fit.free_space_violation,
        h.fit.contradicted,
        h.fit.refuted,
        h.fit.margin,
        h.fit.observability,
        h.counts.inliers);
  }
  std::printf(
      " | %.0f ms (pre %.0f kp %.0f desc %.0f match %.0f pose %.0f icp %.0f ver %.0f) kp %lu\n",
      answer.timings.total.count(),
      answer.timings.preprocess.count(),
      answer.timings.keypoints.count(),
      answer.timings.describe.count(),
      answer.timings.match.count(),
      answer.timings.pose.count(),
      answer.timings.icp.count(),
      answer.timings.verify.count(),
      static_cast<unsigned long>(answer.query.keypoints));
}

int run(const std::filesystem::path& folder, const std::string& only) {
  RunContext context;
  context.threads = 2;
  const RealData data = read_real_data(folder);
  const auto places =
      std::make_unique<Localizer>(index_all(data.places, EntryKind::kPlace, context), context);
  const auto objects =
      std::make_unique<Localizer>(index_all(data.objects, EntryKind::kObject, context), context);
  for (const RealCase& one : data.cases) {
    if (one.id.find(only) == std::string::npos) continue;
    if (!one.database.empty()) {
      const Localizer own(index_all(one.database, EntryKind::kObject, context), context);
      ask(one, own, context);
      continue;
    }
    ask(one, one.kind == "scene" ? *places : *objects, context);
  }
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  const char* folder = argc > 1 ? argv[1] : std::getenv("LANDMARKDB_REAL_DATA");
  if (folder == nullptr) {
    std::fprintf(stderr, "usage: %s [FOLDER [CASE]], or set LANDMARKDB_REAL_DATA\n", argv[0]);
    return 2;
  }
  try {
    return landmarkdb::bench::run(folder, argc > 2 ? argv[2] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
