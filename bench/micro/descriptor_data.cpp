#include "bench/micro/descriptor_data.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/base/error.hpp"
#include "engine/cloud/prepare_cloud.hpp"
#include "engine/cloud/sanitise.hpp"
#include "engine/features/describe_shot.hpp"
#include "engine/retrieval/feature_options.hpp"

namespace landmarkdb::bench {
namespace {

// What the indexer derives for a lobby.
constexpr FeatureOptions kOptions{.voxel_m = 0.05,
                                  .normal_radius_m = 0.125,
                                  .shot_radius_m = 0.5,
                                  .keypoint_spacing_m = 0.15,
                                  .keypoints = KeypointMethod::kStructure};
constexpr std::size_t kScanPoints = 600'000;
constexpr std::size_t kFramesAPlace = 2;
constexpr std::size_t kQueriesAFrame = 200;

std::vector<float> describe(PointCloud cloud, const RunContext& context) {
  const CloudCounts counts = sanitise(cloud, context);
  const PreparedCloud prepared =
      prepare_cloud(cloud, counts, {kOptions.voxel_m, kOptions.normal_radius_m}, context);
  const Keypoints keypoints = detect_keypoints(prepared, keypoint_options(kOptions), context);
  return describe_shot(prepared, keypoints, kOptions.shot_radius_m, context).values;
}

void append_rows(std::vector<float>& to, const std::vector<float>& from, std::size_t most) {
  const std::size_t rows = from.size() / kShotLength;
  const std::size_t count = std::min(most, rows);
  for (std::size_t i = 0; i < count; ++i) {
    const auto* row = from.data() + i * rows / count * kShotLength;
    to.insert(to.end(), row, row + kShotLength);
  }
}

void add_frames(const datasets::Place& place,
                std::uint64_t seed,
                std::size_t wanted,
                std::vector<float>& queries,
                const RunContext& context) {
  const auto poses = datasets::sample_camera_poses(place, kFramesAPlace, seed, {});
  for (std::size_t i = 0; i < poses.size() && queries.size() < wanted * kShotLength; ++i) {
    datasets::DepthCameraOptions camera;
    camera.seed = seed + i;
    append_rows(queries,
                describe(datasets::render_depth(place, poses[i], camera, context).cloud, context),
                std::min(kQueriesAFrame, wanted - queries.size() / kShotLength));
  }
}

using Header = std::array<std::uint64_t, 3>;  // seed, stored, queries

Header header_of(const DescriptorDataOptions& options) {
  return {options.seed, options.stored, options.queries};
}

bool read_rows(std::ifstream& file, std::vector<float>& rows, std::size_t count) {
  rows.resize(count * kShotLength);
  file.read(reinterpret_cast<char*>(rows.data()),
            static_cast<std::streamsize>(rows.size() * sizeof(float)));
  return file.good();
}

bool read_cache(const std::string& name,
                const DescriptorDataOptions& options,
                DescriptorData& data) {
  std::ifstream file(name, std::ios::binary);
  Header header{};
  file.read(reinterpret_cast<char*>(header.data()), sizeof header);
  return file.good() && header == header_of(options) &&
         read_rows(file, data.stored, options.stored) &&
         read_rows(file, data.queries, options.queries);
}

void write_cache(const std::string& name,
                 const DescriptorDataOptions& options,
                 const DescriptorData& data) {
  std::ofstream file(name, std::ios::binary);
  const Header header = header_of(options);
  file.write(reinterpret_cast<const char*>(header.data()), sizeof header);
  for (const auto* rows : {&data.stored, &data.queries}) {
    file.write(reinterpret_cast<const char*>(rows->data()),
               static_cast<std::streamsize>(rows->size() * sizeof(float)));
  }
  if (!file.good()) throw Error(ErrorCode::kInternal, "cannot write '" + name + "'");
}

}  // namespace

DescriptorData make_descriptor_data(const DescriptorDataOptions& options,
                                    const std::string& cache) {
  DescriptorData data;
  if (!cache.empty() && read_cache(cache, options, data)) return data;
  data = {};
  RunContext context;
  context.threads = options.threads;
  const auto types = datasets::all_place_types();
  for (std::size_t i = 0; data.stored.size() < options.stored * kShotLength ||
                          data.queries.size() < options.queries * kShotLength;
       ++i) {
    datasets::PlaceOptions place_options;
    place_options.type = types[i % types.size()];
    place_options.seed = options.seed + i;
    const datasets::Place place = datasets::make_place(place_options);
    datasets::ScannerOptions scanner;
    scanner.points = kScanPoints;
    scanner.seed = options.seed + i;
    append_rows(
        data.stored,
        describe(datasets::merge_stations(datasets::scan_place(place, scanner, context)), context),
        options.stored - data.stored.size() / kShotLength);
    add_frames(place, options.seed + i, options.queries, data.queries, context);
    std::fprintf(stderr,
                 "\r%zu places, %zu stored, %zu queries",
                 i + 1,
                 data.stored.size() / kShotLength,
                 data.queries.size() / kShotLength);
  }
  std::fprintf(stderr, "\n");
  if (!cache.empty()) write_cache(cache, options, data);
  return data;
}

}  // namespace landmarkdb::bench
