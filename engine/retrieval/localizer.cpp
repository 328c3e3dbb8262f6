#include "engine/retrieval/localizer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/retrieval/agreement.hpp"
#include "engine/retrieval/contrast.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/entry_base.hpp"
#include "engine/retrieval/entry_cache.hpp"
#include "engine/retrieval/expected.hpp"
#include "engine/retrieval/explain.hpp"
#include "engine/retrieval/hypothesis.hpp"
#include "engine/retrieval/index_cache.hpp"
#include "engine/retrieval/level.hpp"
#include "engine/retrieval/list_correspondences.hpp"
#include "engine/retrieval/query_view.hpp"
#include "engine/retrieval/scene_view.hpp"
#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"

namespace landmarkdb {

struct Localizer::State {
  std::shared_ptr<const Catalog> catalog;
  std::unique_ptr<EntryCache> entries;  // as in the catalogue
  std::size_t on_demand = 0;            // of them
  std::vector<Level> levels;
  mutable IndexCache indexes;  // thread-safe
};

namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& message) {
  throw Error(ErrorCode::kInvalidArgument, message, field);
}

void check_options(const QueryOptions& options) {
  const auto share = [](double v) { return std::isfinite(v) && v >= 0.0 && v <= 1.0; };
  if (!share(options.min_confidence)) {
    refuse("min_confidence",
           "min-confidence is " + std::to_string(options.min_confidence) + ", want 0..1");
  }
  if (!share(options.ratio) || options.ratio == 0.0) {
    refuse("ratio",
           "ratio is " + std::to_string(options.ratio) + ", want more than 0 and at most 1");
  }
  if (options.top < 1 || options.top > kMostHypotheses) {
    refuse(
        "top",
        "top is " + std::to_string(options.top) + ", want 1 to " + std::to_string(kMostHypotheses));
  }
  if (options.want_scene_points > kMostSceneViewPoints) {
    refuse("want_scene_points",
           "want_scene_points is " + std::to_string(options.want_scene_points) + ", want at most " +
               std::to_string(kMostSceneViewPoints));
  }
  if (options.up && !(options.up->allFinite() && options.up->norm() > 0.0)) {
    refuse("up", "the up direction must be finite and longer than zero");
  }
  if (options.profile == Profile::kRobust && !options.filters.empty()) {
    refuse("filters",
           "filters belong to the profile paper: the robust one tests what every pair proposes");
  }
  if (options.profile == Profile::kRobust && options.solver != Solver::kSimilarity) {
    refuse("solver", "the solver pnp belongs to the profile paper: the robust one solves no pairs");
  }
  if (options.solver == Solver::kPnp && options.estimate_scale) {
    refuse("scale", "the solver pnp takes directions, which say nothing of scale");
  }
  if (options.profile == Profile::kRobust && options.estimate_scale) {
    refuse("scale",
           "scale is estimated by the profile paper only: the robust one takes both as metric");
  }
  if (options.prior_T_scene_sensor &&
      !(options.prior_T_scene_sensor->matrix().allFinite() &&
        std::isfinite(options.prior_radius_m) && options.prior_radius_m > 0.0)) {
    refuse(
        "prior_radius",
        "a prior needs a radius of more than 0 m, not " + std::to_string(options.prior_radius_m));
  }
}

std::vector<bool> wanted_entries(const Entries& entries, const QueryOptions& options) {
  std::vector<bool> wanted(entries.size(), options.scenes.empty());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries.is_damaged(i)) wanted[i] = false;
  }
  for (const std::string& name : options.scenes) {
    bool known = false;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].record().name != name) continue;
      if (entries.is_damaged(i)) {
        throw Error(
            ErrorCode::kDataLoss, "scene '" + name + "' is damaged and not served", "scene");
      }
      wanted[i] = true;
      known = true;
    }
    if (!known) throw Error(ErrorCode::kNotFound, "there is no scene '" + name + "'", "scene");
  }
  return wanted;
}

// Whether damage, some of it just found, leaves nothing to be looked in.
bool all_are_damaged(const Entries& entries, const std::vector<bool>& wanted) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (wanted[i] && !entries.is_damaged(i)) return false;
  }
  return true;
}

std::string nothing_left(const SearchResult& search,
                         const CleanQuery& query,
                         const ViewCache& views) {
  if (search.lost_at == "density") {
    return "keypoints: the cloud's points are " + std::to_string(query.scale.spacing_m) +
           " m apart, too far for every entry asked";
  }
  if (search.lost_at == "keypoints") {
    return "keypoints: " + std::to_string(query.cloud.size()) + " points gave " +
           std::to_string(views.keypoints()) +
           " descriptors; is the cloud one plane, or too small a part?";
  }
  if (search.lost_at == "filter") return "filter: no four pairs that one motion explains were left";
  return (search.lost_at.empty() ? "pose" : search.lost_at) +
         ": no proposal lies on the surface of any entry";
}

void add_warnings(const CleanQuery& query,
                  const QueryOptions& options,
                  const Verdict& verdict,
                  const Entries& entries,
                  QueryResult& answer) {
  if (units_look_wrong(query.scale, EntryKind::kPlace)) {
    answer.warnings.emplace_back("units_suspect");
  }
  if (verdict.judged.empty()) return;
  const Assessed& best = verdict.judged[0].pose;
  constexpr double kLowOverlap = 0.6;
  constexpr double kPlanar = 0.003;  // a lone wall measures below, the dullest corner above
  constexpr double kDensity = 3.0;
  if (best.evidence.overlap < kLowOverlap) answer.warnings.emplace_back("low_overlap");
  if (best.evidence.observability < kPlanar) answer.warnings.emplace_back("planar_scene");
  if (options.up && !entries[best.entry].record().up) {
    answer.warnings.emplace_back("gravity_unknown");
  }
  answer.query.density_ratio =
      query.scale.spacing_m > 0.0
          ? entries[best.entry].record().options.voxel_m / query.scale.spacing_m
          : 1.0;
  if (answer.query.density_ratio < 1.0 / kDensity) answer.warnings.emplace_back("density_mismatch");
}

// Hypotheses of the answer: for "ambiguous" every rival, otherwise the best and what came behind.
void fill_hypotheses(const SearchInput& input,
                     const SearchResult& search,
                     const Verdict& verdict,
                     QueryResult& answer) {
  for (const Judged& judged : verdict.judged) {
    if (answer.hypotheses.size() >= input.options.top) break;
    answer.hypotheses.push_back(make_hypothesis(judged, input, search));
  }
  if (input.options.want_correspondences) {
    CorrespondenceList list = list_correspondences(verdict, input, search);
    answer.correspondences = std::move(list.records);
    if (list.cut) answer.warnings.emplace_back("correspondences_cut");
  }
  if (input.options.want_scene_points == 0) return;
  for (std::size_t i = 0; i < std::min(answer.hypotheses.size(), kMostSceneViews); ++i) {
    answer.scene_views.push_back(
        make_scene_view(verdict.judged[i], input, search, input.options.want_scene_points));
  }
}

}  // namespace

Localizer::Localizer(std::shared_ptr<const Catalog> catalog,
                     const RunContext& context,
                     const LocalizerOptions& options) {
  auto state = std::make_unique<State>();
  state->catalog = std::move(catalog);
  const std::size_t most_scanned_rows =
      options.most_scanned_rows > 0 ? options.most_scanned_rows : kMostScannedRows;
  EntryBase base = make_entry_base(*state->catalog, most_scanned_rows, context);
  state->entries = std::make_unique<EntryCache>(
      std::move(base.entries), options.scene_memory_bytes, options.on_damaged);
  for (std::size_t i = 0; i < base.damage.size(); ++i) {
    if (!base.damage[i].empty()) {
      state->entries->set_aside(i, base.damage[i]);
    } else if (state->entries->base(i)->stored.source != nullptr) {
      ++state->on_demand;
    }
  }
  state->levels =
      make_levels(Entries(*state->entries), context, most_scanned_rows, [&](std::size_t entry) {
        return std::exchange(base.codes[entry], std::nullopt);
      });
  state_ = std::move(state);
}

Localizer::~Localizer() = default;

const Catalog& Localizer::catalog() const { return *state_->catalog; }

std::vector<std::pair<std::size_t, std::string>> Localizer::damaged() const {
  std::vector<std::pair<std::size_t, std::string>> damaged;
  for (std::size_t i = 0; i < state_->entries->size(); ++i) {
    std::string what = state_->entries->damage(i);
    if (!what.empty()) damaged.emplace_back(i, std::move(what));
  }
  return damaged;
}

LoadedScenes Localizer::loaded() const {
  const EntryCache& entries = *state_->entries;
  return {state_->on_demand, entries.bytes(), entries.loads(), entries.let_go()};
}

QueryResult Localizer::query(const PointCloud& cloud,
                             const QueryOptions& options,
                             const RunContext& context) const {
  return query(std::vector<QueryCloud>{{cloud}}, options, context);
}

QueryResult Localizer::query(std::vector<QueryCloud> clouds,
                             const QueryOptions& options,
                             const RunContext& context) const {
  check_options(options);
  QueryResult answer;
  const StageTimer total(answer.timings.total);
  answer.seed = options.seed;
  Entries entries(*state_->entries);
  const std::vector<bool> wanted = wanted_entries(entries, options);

  context.report("preprocess", 0, 1);
  const CleanQuery query = [&] {
    const StageTimer timer(answer.timings.preprocess);
    return clean_query(std::move(clouds), context);
  }();
  if (options.solver == Solver::kPnp && query.cloud.viewpoints.size() > 1) {
    refuse("solver",
           "the solver pnp takes directions from one viewpoint, the clouds have " +
               std::to_string(query.cloud.viewpoints.size()));
  }
  answer.query.points = query.counts.points;
  answer.query.points_used = query.counts.used;
  answer.query.invalid = query.counts.invalid();
  constexpr std::size_t kFewest = 4;
  if (query.cloud.size() < kFewest) {
    answer.reason = "preprocess: " + std::to_string(query.cloud.size()) + " usable points of " +
                    std::to_string(query.counts.points) + ", want at least 4";
    if (options.explain) answer.explanation = explain_unsearched(answer);
    return answer;
  }
  if (entries.empty()) {
    answer.reason = "match: the database has no scenes";
    if (options.explain) answer.explanation = explain_unsearched(answer);
    return answer;
  }

  ViewCache views(query, options.seed, context, answer.timings);
  const SearchInput input{query,
                          options,
                          entries,
                          state_->levels,
                          wanted,
                          views,
                          state_->indexes,
                          answer.timings,
                          context};
  SearchResult search;
  if (options.profile == Profile::kPaper) {
    search_paper(input, search);
  } else {
    search_places(input, search);
    search_objects(input, search);
  }
  answer.query.keypoints = views.keypoints();
  const std::vector<Assessed> dropped = keep_expected(input, search.poses);

  {
    const StageTimer timer(answer.timings.verify);
    count_agreeing(input, search);
    contrast_poses(input, search);
  }
  VerdictOptions verdict_options;
  verdict_options.min_confidence = options.min_confidence;
  const Verdict verdict = judge(search.poses, entries, query.centre, verdict_options);
  answer.status = verdict.status;
  if (answer.status == QueryStatus::kNotFound) {
    if (!search.poses.empty()) {
      answer.reason = verdict.reason;
    } else if (!dropped.empty()) {
      answer.reason = "verify: all " + std::to_string(dropped.size()) +
                      " poses contradict the up direction or the prior";
    } else if (all_are_damaged(entries, wanted)) {
      answer.reason = "match: every scene asked is damaged and not served; `health` says how";
    } else {
      answer.reason = nothing_left(search, query, views);
    }
  }
  add_warnings(query, options, verdict, entries, answer);
  fill_hypotheses(input, search, verdict, answer);
  if (options.explain) {
    answer.explanation = explain({input, search, dropped, verdict, verdict_options, answer});
  }
  return answer;
}

}  // namespace landmarkdb
