// A corridor whose floors are exact copies, scanned as one scene: no frame can tell which it was
// taken on.

#include <memory>

#include <gtest/gtest.h>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/localizer.hpp"

namespace landmarkdb {
namespace {

TEST(CopiedFloors, AreNeverToldApart) {
  datasets::PlaceOptions options;
  options.type = datasets::PlaceType::kCorridor;
  options.seed = 31;
  options.size = 0.5;
  options.floors = 2;
  options.copies = datasets::FloorCopies::kExact;
  const datasets::Place place = datasets::make_place(options);
  RunContext context;
  context.threads = 2;
  datasets::ScannerOptions scanner;
  scanner.points = 200'000;
  scanner.seed = 31;
  std::vector<Scan> scans(1);
  scans[0].cloud = datasets::merge_stations(datasets::scan_place(place, scanner, context));
  CatalogEntry entry;
  entry.scene_id = entry.version = 1;
  entry.record =
      std::make_shared<SceneRecord>(describe_scene("corridor", std::move(scans), {}, context));
  auto catalog = std::make_shared<Catalog>();
  catalog->entries.push_back(std::move(entry));
  const Localizer localizer(catalog, context);

  constexpr std::size_t kFrames = 6;
  int ambiguous = 0;
  for (const Eigen::Isometry3d& pose : datasets::sample_camera_poses(place, kFrames, 31)) {
    const auto frame = datasets::render_depth(place, pose, {}, context);
    const QueryResult answer = localizer.query(frame.cloud, {}, context);
    EXPECT_NE(answer.status, QueryStatus::kLocalized)
        << answer.hypotheses[0].confidence << " by " << answer.hypotheses[0].fit.margin;
    ambiguous += answer.status == QueryStatus::kAmbiguous ? 1 : 0;
  }
  EXPECT_GE(ambiguous, 2);
}

}  // namespace
}  // namespace landmarkdb
