#include "bench/mono/funnel.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "bench/mono/pictures.hpp"
#include "engine/mono/draw_overlay.hpp"
#include "engine/mono/find_features.hpp"
#include "engine/mono/pose_check.hpp"
#include "engine/mono/recognize_confidence.hpp"
#include "engine/mono/recognizer.hpp"

namespace landmarkdb::bench {
namespace {

using nlohmann::json;

constexpr std::size_t kBatch = 50;  // pictures with a catalogue of their own, as calibrate has them
constexpr double kReach_px = 8.0;

enum Stage { kFeatures, kRefinement, kWeak, kSearch, kRank, kDoubt, kFound, kStages };
constexpr std::array<const char*, kStages> kNames{
    "too few features at the true pose",
    "lost in refinement from the true pose",
    "too weak, were nothing else there",
    "the search came to no such pose",
    "another hypothesis before it",
    "first, and too little confidence",
    "recognized",
};

struct Bench {
  std::shared_ptr<const MonoCatalog> catalog;
  std::vector<SearchModel> models;
  Recognizer recognizer;

  explicit Bench(std::shared_ptr<const MonoCatalog> made)
      : catalog(std::move(made)), recognizer(catalog) {
    for (const MonoCatalogEntry& entry : catalog->entries)
      models.push_back(prepare_model(entry.record, tables_of(*entry.record, {})));
  }
};

// What speaks for the true pose, and how far it gets by itself.
struct Truth {
  Stage stage = kFeatures;
  MonoCandidate candidate{};
  double confidence = 0.0;
};

Truth test_truth(const Bench& bench, const Picture& picture, const ImageFeatures& features) {
  Truth truth;
  const auto model = static_cast<std::uint32_t>(picture.shown);
  const ImageView image(features, picture.camera, kReach_px);
  const EdgeGrid edges(features);
  if (image.size() < 4) return truth;
  PoseCheck check(bench.models, image, edges, picture.camera, {});
  const RigidPose pose{picture.T_camera_object.linear(), picture.T_camera_object.translation()};
  const auto found = check.look(model, pose);
  if (found.empty()) return truth;
  truth.stage = kRefinement;
  const std::vector<Match> matches(found.begin(), found.end());
  std::optional<MonoCandidate> candidate = check.settle(model, pose, matches);
  if (!candidate) return truth;
  check.settle_on_edges(*candidate);
  if (!is_right_pose(
          bench.models[model].model(), candidate->pose.isometry(), picture.T_camera_object)) {
    return truth;
  }
  check.judge_shape(*candidate);
  constexpr double kNoRival = 10.0;
  truth.confidence =
      recognition_confidence({.log10_nfa = candidate->rank(),
                              .matched = static_cast<double>(candidate->matches.size()),
                              .visible = static_cast<double>(candidate->visible),
                              .rms_px = candidate->rms_px,
                              .has_edges = true,
                              .edge_share = candidate->edge_share,
                              .edges = candidate->edges,
                              .shape_odds = candidate->shape_odds,
                              .face_odds = candidate->face_odds,
                              .margin = kNoRival});
  truth.candidate = std::move(*candidate);
  truth.stage = truth.confidence < 0.5 ? kWeak : kSearch;
  return truth;
}

bool is_right(const Bench& bench, const Picture& picture, const MonoHypothesis& hypothesis) {
  if (picture.shown < 0) return false;
  const MonoModel& model = bench.models[static_cast<std::size_t>(picture.shown)].model();
  return hypothesis.model == model.name &&
         is_right_pose(model, hypothesis.T_camera_object, picture.T_camera_object);
}

Stage stage_of(const Bench& bench,
               const Picture& picture,
               const RecognizeResult& result,
               const Truth& truth) {
  const auto& told = result.hypotheses;
  const auto right = std::find_if(
      told.begin(), told.end(), [&](const auto& one) { return is_right(bench, picture, one); });
  if (right == told.end()) return truth.stage;
  if (right != told.begin()) return kRank;
  return result.status == RecognizeStatus::kRecognized ? kFound : kDoubt;
}

// The best hypothesis green, the truth blue.
void draw(const Bench& bench,
          const Picture& picture,
          const ImageFeatures& features,
          const RecognizeResult& result,
          const std::filesystem::path& file) {
  std::vector<OverlayModel> drawn;
  for (const MonoHypothesis& hypothesis : result.hypotheses) {
    for (const SearchModel& model : bench.models) {
      if (model.model().name == hypothesis.model) drawn.push_back({&model.model(), &hypothesis});
    }
    break;
  }
  MonoHypothesis truth;
  truth.T_camera_object = picture.T_camera_object;
  if (picture.shown >= 0) {
    drawn.push_back({&bench.models[static_cast<std::size_t>(picture.shown)].model(), &truth});
  }
  std::ofstream(file, std::ios::binary)
      << draw_overlay(picture.image, features, picture.camera, drawn);
}

}  // namespace

json funnel(const Settings& settings) {
  std::array<std::size_t, kStages> counts{};
  json rows = json::array();
  std::size_t known = 0;
  for (std::size_t first = 0; first < settings.pictures; first += kBatch) {
    const PictureOptions options{.models = settings.picture_models,
                                 .pictures = std::min(kBatch, settings.pictures - first),
                                 .seed = settings.seed + first / kBatch};
    const Bench bench(make_picture_catalog(options.seed, options.models));
    for (std::size_t i = 0; i < options.pictures; ++i) {
      const Picture picture = make_picture(*bench.catalog, options, i);
      const ImageFeatures features = find_image_features(picture.image, {}, {});
      const RecognizeResult result =
          bench.recognizer.recognize(features, picture.camera, {.top = 10}, {});
      const Truth truth = picture.shown < 0 ? Truth{} : test_truth(bench, picture, features);
      const Stage stage = stage_of(bench, picture, result, truth);
      const bool accepted = result.status == RecognizeStatus::kRecognized;
      const std::string name = picture.shown >= 0 ? kNames[stage] : accepted ? "wrong" : "declined";
      if (picture.shown >= 0) {
        ++known;
        ++counts[stage];
      }
      json row{{"picture", first + i}, {"outcome", name}, {"points", features.points.size()}};
      if (!result.hypotheses.empty()) {
        const MonoHypothesis& best = result.hypotheses.front();
        row.update({{"model", best.model},
                    {"confidence", best.confidence},
                    {"log10_nfa", best.log10_nfa},
                    {"edge_share", best.edge_share},
                    {"matched", best.pairs.size()},
                    {"visible", best.visible_points},
                    {"rms_px", best.rms_px},
                    {"margin", best.margin}});
      }
      if (truth.stage > kRefinement) {
        row["truth"] = {{"confidence", truth.confidence},
                        {"log10_nfa", truth.candidate.rank()},
                        {"edge_share", truth.candidate.edge_share},
                        {"matched", truth.candidate.matches.size()},
                        {"visible", truth.candidate.visible},
                        {"rms_px", truth.candidate.rms_px}};
      }
      rows.push_back(row);
      if (!settings.overlays.empty()) {
        const std::string file = std::to_string(first + i) + " " + name + ".png";
        draw(bench, picture, features, result, std::filesystem::path(settings.overlays) / file);
      }
    }
  }
  std::printf("%zu pictures with a known object\n", known);
  for (std::size_t stage = 0; stage < kStages; ++stage)
    std::printf("%5zu %s\n", counts[stage], kNames[stage]);
  return {{"known", known}, {"pictures", rows}};
}

}  // namespace landmarkdb::bench
