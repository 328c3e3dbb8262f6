#include "engine/mono/recognizer.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/mono/answer.hpp"
#include "engine/mono/candidate_pool.hpp"
#include "engine/mono/corner_search.hpp"
#include "engine/mono/find_features.hpp"
#include "engine/mono/four_index.hpp"
#include "engine/mono/four_search.hpp"
#include "engine/mono/image_fours.hpp"
#include "engine/mono/image_quads.hpp"
#include "engine/mono/mirror_rival.hpp"
#include "engine/mono/quad_index.hpp"
#include "engine/mono/rivals.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/mono/search_tables.hpp"
#include "engine/mono/vote_search.hpp"

namespace landmarkdb {
namespace {

// Fours of image points whose codes are worked out: at 60 features all there are; 400 linked ones
// would give a million.
constexpr std::size_t kMostQuads = 20000, kMostFours = 20000;
// Those with two links only are many and say little: a sample of them.
constexpr std::size_t kMostPairs = 3000;
// Single votes tried of either. By landmarkdb-bench-mono (seed 11, 100 models, 60 features): 4000
// of the second, and twice the pairs, find no more and take a quarter longer; 1000 of each lose 6
// in 100 with 6 or 7 true features.
constexpr std::size_t kMostSingles = 4000, kMostSinglesOfPairs = 2000;
constexpr double kReach_px = 8.0;  // of the table of nearest features: the quick look's tolerance
constexpr double kImageWidth_px = 640.0;  // the pixel tolerances are those of such an image
constexpr std::size_t kFewest = 4;        // points that fix a pose

double scale_of(const ImageFeatures& features) {
  return std::max(1.0, std::max(features.width, features.height) / kImageWidth_px);
}

void check_request(const ImageFeatures& features,
                   const Camera& camera,
                   const RecognizeOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::kInvalidArgument, what);
  };
  if (features.width != camera.width || features.height != camera.height) {
    refuse("the camera is for images of " + std::to_string(camera.width) + " x " +
           std::to_string(camera.height) + " pixels, the image has " +
           std::to_string(features.width) + " x " + std::to_string(features.height));
  }
  if (!(camera.fx > 0.0) || camera.fy == 0.0 || !std::isfinite(camera.fx) ||
      !std::isfinite(camera.fy) || !std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    refuse("the camera's focal lengths and principal point are not usable");
  }
  if (!(options.min_depth_m > 0.0) || !(options.max_depth_m > options.min_depth_m)) {
    refuse("the depth range is empty, want 0 < min_depth_m < max_depth_m");
  }
}

// What is worked out of each model, in the catalogue's order.
struct Prepared {
  std::vector<SearchModel> models;
  std::vector<SearchModel> mirrors;
  std::vector<CornerModel> corners;
};

Prepared prepare(const MonoCatalog& catalog, const RunContext& context) {
  struct One {
    SearchModel model, mirror;
    CornerModel corners;
  };
  RunContext quiet = context;  // progress is told from the calling thread only
  quiet.progress = nullptr;
  std::vector<std::optional<One>> made(catalog.entries.size());
  parallel_chunks(made.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::shared_ptr<const MonoModelRecord>& record = catalog.entries[i].record;
      const SearchTables tables = tables_of(*record, quiet, QuadUse::kLeftOut);
      SearchModel model = prepare_model(record, tables);
      CornerModel corners = prepare_corners(model);
      made[i] = One{std::move(model), prepare_mirror(*record, tables), std::move(corners)};
    }
  });
  Prepared prepared;
  for (std::optional<One>& one : made) {
    prepared.models.push_back(std::move(one->model));
    prepared.mirrors.push_back(std::move(one->mirror));
    prepared.corners.push_back(std::move(one->corners));
  }
  return prepared;
}

}  // namespace

class Recognizer::Impl {
 public:
  Impl(std::shared_ptr<const MonoCatalog> catalog, const RunContext& context)
      : Impl(catalog, prepare(*catalog, context), context) {}

  RecognizeResult recognize(const ImageFeatures& features,
                            const Camera& camera,
                            const RecognizeOptions& options,
                            const RunContext& run) const;

 private:
  Impl(std::shared_ptr<const MonoCatalog> catalog, Prepared prepared, const RunContext& context)
      : catalog_(std::move(catalog)),
        models_(std::move(prepared.models)),
        corner_models_(std::move(prepared.corners)),
        mirrors_(std::move(prepared.mirrors)),
        fours_(models_, context.threads),
        by_quads_(models_by_quads()),
        index_(models_, context, by_quads_),
        threads_(context.threads) {}
  std::vector<char> models_by_quads() const;
  const QuadIndex& all_quads() const;
  std::vector<char> wanted(const RecognizeOptions& options) const;
  bool search(const ImageView& image,
              std::span<const char> wanted,
              const RecognizeOptions& options,
              const RunContext& run,
              CandidatePool& pool,
              RecognizeTimings& timings) const;

  std::shared_ptr<const MonoCatalog> catalog_;
  std::vector<SearchModel> models_;
  std::vector<CornerModel> corner_models_;  // as models_
  std::vector<SearchModel> mirrors_;        // of the models, in their order
  FourIndex fours_;
  std::vector<char> by_quads_;  // by model: in index_
  QuadIndex index_;
  int threads_ = 1;
  mutable std::once_flag all_quads_made_;
  mutable std::optional<QuadIndex> all_quads_;  // made when first asked for
};

// The models that are looked up by quads in images with links: those without edges, and those whose
// linked fours are often flat.
std::vector<char> Recognizer::Impl::models_by_quads() const {
  std::vector<char> result(models_.size());
  for (std::uint32_t i = 0; i < models_.size(); ++i)
    result[i] = fours_.often_flat(i) || !is_linked(models_[i].model()) ? 1 : 0;
  return result;
}

// An image without links has no fours: every model is looked up by quads then. They take longest to
// make and most of the memory, 1.5 MB a model of twenty points, and most servers never see such an
// image.
const QuadIndex& Recognizer::Impl::all_quads() const {
  std::call_once(all_quads_made_, [&] {
    RunContext context;  // not the request's: a deadline that is too short would never let it end
    context.threads = threads_;
    all_quads_.emplace(models_, context);
  });
  return *all_quads_;
}

std::vector<char> Recognizer::Impl::wanted(const RecognizeOptions& options) const {
  std::vector<char> result(models_.size(), options.models.empty() ? 1 : 0);
  for (const std::string& name : options.models) {
    bool found = false;
    for (std::size_t i = 0; i < models_.size(); ++i) {
      if (models_[i].model().name != name) continue;
      result[i] = 1;
      found = true;
    }
    if (!found) throw Error(ErrorCode::kInvalidArgument, "there is no model \"" + name + "\"");
  }
  return result;
}

bool Recognizer::Impl::search(const ImageView& image,
                              std::span<const char> wanted,
                              const RecognizeOptions& options,
                              const RunContext& run,
                              CandidatePool& pool,
                              RecognizeTimings& timings) const {
  bool any_linked = false, any_flat = false, any_left_out = false;
  unsigned free_types = 0;
  std::vector<char> by_fours(models_.size(), 0), flat(models_.size(), 0);
  for (std::uint32_t i = 0; i < models_.size(); ++i) {
    if (!wanted[i]) continue;
    if (is_linked(models_[i].model()) && image.link_count() > 0) {
      by_fours[i] = 1;
      flat[i] = fours_.often_flat(i) ? 1 : 0;
      any_linked = true;
      any_flat = any_flat || flat[i] != 0;
      continue;
    }
    any_left_out = any_left_out || by_quads_[i] == 0;
    for (const ModelFeature& point : models_[i].model().points)
      free_types |= 1U << static_cast<unsigned>(point.type);
  }
  bool complete = true;
  if (any_linked) {
    ImageFours fours;
    {
      const StageTimer timer(timings.lookup);
      fours = linked_fours(image, kMostFours);
    }
    const StageTimer timer(timings.verify);
    complete = search_by_fours(models_,
                               fours_,
                               image,
                               fours.fours,
                               {options.min_depth_m, options.max_depth_m, by_fours},
                               run,
                               pool) &&
               !fours.cut_short;
  }
  VoteOptions votes{options.min_depth_m, options.max_depth_m, flat, kMostSingles};
  for (const auto find_quads : {chained_quads, linked_quads}) {
    if (!any_flat || pool.beyond_doubt()) break;
    ImageQuads quads;
    {
      const StageTimer timer(timings.lookup);
      quads = find_quads(image, find_quads == linked_quads ? kMostPairs : kMostQuads);
    }
    const StageTimer timer(timings.verify);
    votes.most_singles = find_quads == linked_quads ? kMostSinglesOfPairs : kMostSingles;
    complete = search_by_votes(models_, index_, image, quads.quads, votes, run, pool) &&
               !quads.cut_short && complete;
  }
  if (free_types != 0) {
    votes.most_singles = kMostSingles;
    votes.wanted = wanted;
    ImageQuads quads;
    {
      const StageTimer timer(timings.lookup);
      quads = free_quads(image, free_types, kMostQuads);
    }
    const StageTimer timer(timings.verify);
    const QuadIndex& index = any_left_out ? all_quads() : index_;
    complete = search_by_votes(models_, index, image, quads.quads, votes, run, pool) &&
               !quads.cut_short && complete;
  }
  return complete;
}

RecognizeResult Recognizer::Impl::recognize(const ImageFeatures& features,
                                            const Camera& camera,
                                            const RecognizeOptions& options,
                                            const RunContext& run) const {
  RecognizeResult result;
  const StageTimer total(result.timings.total);
  check_request(features, camera, options);
  const std::vector<char> wanted_models = wanted(options);
  result.image_points = features.points.size();
  result.seed = options.seed;
  run.check("lookup");
  const double scale = scale_of(features);
  const ImageView image(features, camera, kReach_px * scale);
  if (image.left_out() > 0) result.warnings.push_back("outside_lens_model");
  if (models_.empty()) {
    result.reason = "there is no model to look for";
    return result;
  }
  if (image.size() < kFewest) {
    result.reason =
        "the image has " + std::to_string(image.size()) + " usable feature points, want at least 4";
    return result;
  }
  const EdgeGrid edges(features);
  CheckOptions check_options{.min_depth_m = options.min_depth_m,
                             .max_depth_m = options.max_depth_m,
                             .log10_tests = 5.0,
                             .scale = scale};
  PoseCheck check(models_, image, edges, camera, check_options);
  CandidatePool pool(models_, check);
  bool complete = search(image, wanted_models, options, run, pool, result.timings);
  if (!edges.empty() && !pool.beyond_doubt()) {
    const StageTimer timer(result.timings.verify);
    complete = search_by_corners(models_,
                                 corner_models_,
                                 features,
                                 camera,
                                 edges,
                                 {options.min_depth_m, options.max_depth_m, wanted_models, scale},
                                 run,
                                 pool) &&
               complete;
  }
  if (!complete) result.warnings.push_back("search_cut_short");
  {
    const StageTimer timer(result.timings.refine);
    PoseCheck mirrors(mirrors_, image, edges, camera, check_options);
    settle_rivals(models_, image, camera, check, mirrors, pool, run);
  }
  write_answer(models_, image, edges, pool.candidates(), options, scale, result);
  if (result.status == RecognizeStatus::kNotFound && !complete) {
    result.reason += "; there was more to look at than the limit allows";
  }
  return result;
}

Recognizer::Recognizer(std::shared_ptr<const MonoCatalog> catalog, const RunContext& context)
    : impl_(std::make_unique<const Impl>(std::move(catalog), context)) {}

Recognizer::~Recognizer() = default;

RecognizeResult Recognizer::recognize(const GreyImage& image,
                                      const Camera& camera,
                                      const RecognizeOptions& options,
                                      const RunContext& run) const {
  StageTimings::Duration finding{};
  ImageFeatures features;
  {
    const StageTimer timer(finding);
    features = find_image_features(image, FeatureSearchOptions{}, run);
  }
  RecognizeResult result = impl_->recognize(features, camera, options, run);
  result.timings.features = finding;
  result.timings.total += finding;
  return result;
}

RecognizeResult Recognizer::recognize(const ImageFeatures& features,
                                      const Camera& camera,
                                      const RecognizeOptions& options,
                                      const RunContext& run) const {
  return impl_->recognize(features, camera, options, run);
}

}  // namespace landmarkdb
