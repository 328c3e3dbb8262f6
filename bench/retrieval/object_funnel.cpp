#include "bench/retrieval/object_funnel.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "bench/retrieval/pose_errors.hpp"
#include "engine/registration/propose.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb::bench {

namespace {

bool close(const datasets::ObjectModel& model,
           const Eigen::Isometry3d& truth,
           const Eigen::Isometry3d& T,
           double share,
           double degrees) {
  const auto error = datasets::object_error(model, truth, T);
  return error.symmetric_metres <= share * model.extent_m && error.symmetric_degrees <= degrees;
}

Eigen::Isometry3d pose_of(const Proposal& proposal) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = proposal.R_target_source.cast<double>();
  T.translation() = proposal.t_target_source.cast<double>();
  return T;
}

struct Followed {
  std::size_t pairs = 0, near = 0, loose = 0;
};

Followed follow_pairs(const EntryMatches& matches,
                      const Entry& entry,
                      const datasets::ObjectModel& model,
                      const Eigen::Isometry3d& T_sensor_object) {
  Followed followed;
  std::vector<Correspondence> turned = matches.putative;
  for (Correspondence& pair : turned) std::swap(pair.query, pair.target);
  followed.pairs = turned.size();
  for (const Proposal& proposal : propose_from_frames(turned,
                                                      matches.view->descriptors,
                                                      entry.record().descriptors,
                                                      std::nullopt,
                                                      std::nullopt)) {
    const Eigen::Isometry3d T = pose_of(proposal);
    followed.near += close(model, T_sensor_object, T, 0.1, 12.0) ? 1U : 0U;
    followed.loose += close(model, T_sensor_object, T, 0.2, 25.0) ? 1U : 0U;
  }
  return followed;
}

}  // namespace

std::string object_funnel_text(const ObjectCatalog& objects,
                               const AskedScene& asked,
                               const QueryOptions& options,
                               const RunContext& context) {
  std::vector<Entry> entries;
  for (const CatalogEntry& stored : objects.catalog->entries) entries.push_back(make_entry(stored));
  StageTimings timings;
  const CleanQuery query = clean_query(asked.scene.frame.cloud);
  ViewCache views(query, options.seed, context, timings);
  const std::vector<bool> wanted(entries.size(), true);
  IndexCache indexes;
  const std::vector<Level> levels;
  Entries seen(entries);
  const SearchInput input{query, options, seen, levels, wanted, views, indexes, timings, context};
  SearchResult result;
  search_objects(input, result);
  std::stable_sort(result.poses.begin(),
                   result.poses.end(),
                   [](const Assessed& a, const Assessed& b) { return a.score > b.score; });
  std::string text;
  for (const datasets::Standing& thing : asked.scene.things) {
    if (thing.model >= asked.known) continue;
    const datasets::ObjectModel& model = *asked.models[thing.model];
    const Eigen::Isometry3d T_sensor_object =
        asked.scene.frame.T_scene_camera.inverse() * thing.T_scene_object;
    Followed followed;
    std::size_t e = 0;
    while (entries[e].record().name != model.name) ++e;
    for (const EntryMatches& matches : result.matches) {
      if (matches.entry == e) followed = follow_pairs(matches, entries[e], model, T_sensor_object);
    }
    int place = -1;
    double score = 0.0;
    double other = 0.0;
    for (std::size_t i = 0; i < result.poses.size(); ++i) {
      if (result.poses[i].entry != e) continue;
      const bool near =
          close(model, T_sensor_object, result.poses[i].T_entry_sensor.inverse(), 0.1, 8.0);
      if (near && place < 0) {
        place = static_cast<int>(i);
        score = result.poses[i].score;
      }
      if (!near) other = std::max(other, result.poses[i].score);
    }
    char line[300];
    std::snprintf(line,
                  sizeof line,
                  "#funnel %s unhidden %.2f pixels %zu voxel %.4f keypoints %zu pairs %zu near %zu "
                  "loose %zu assessed %d score %.3f other %.3f\n",
                  model.name.c_str(),
                  thing.unhidden,
                  thing.pixels,
                  entries[e].record().options.voxel_m,
                  entries[e].record().descriptors.size(),
                  followed.pairs,
                  followed.near,
                  followed.loose,
                  place,
                  score,
                  other);
    text += line;
  }
  return text;
}

}  // namespace landmarkdb::bench
