#include "engine/mono/four_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "engine/mono/four_metric.hpp"
#include "engine/mono/four_pose.hpp"
#include "engine/mono/four_screen.hpp"
#include "engine/mono/line_of_sight.hpp"
#include "engine/mono/quad_code.hpp"

namespace landmarkdb {
namespace {

using Ids = std::array<std::uint16_t, 4>;

// Of |w^T G w| against w^H G w, before perspective is corrected. On generated scenes (100 models,
// seed 11, 0.5 to 1.2 m, 1 px of noise) nine in ten true fours are below.
constexpr float kTolerance = 0.15F;
// And after it, in sigmas of what noise makes of it: 90 in 100 are below, and of 98 in 100 scenes
// one below 1.05; a tenth of the others.
constexpr double kMostSigmas = 1.6;
constexpr double kNoise_px = 1.0;  // of a feature: the search's, whatever the features say
// Pairs tested in one go, a nanosecond each: at first few, as often one of the first fours is
// the model's, then twice as many each time; and in a whole search.
constexpr std::size_t kFirstBatch = 150'000, kMostBatch = 2'400'000;
constexpr std::size_t kMostTests = 24'000'000;
// Poses whose points are counted, a microsecond each. Of these the best of each batch are tried at
// once, some 15 us each, and the best of the others in the end.
constexpr std::size_t kMostPoses = 30'000;
constexpr std::size_t kTriedAtOnce = 8, kTriedLast = 400;

struct Trial {
  double sigmas = 0.0;
  std::uint32_t model_four = 0;
  std::uint32_t image_four = 0;
  std::uint8_t order = 0;  // of orders_of
};

Ids in_order(const ImageFour& four, std::uint8_t order) {
  const std::array<std::uint8_t, 4>& places = orders_of(four.shape)[order];
  return {four.ids[places[0]], four.ids[places[1]], four.ids[places[2]], four.ids[places[3]]};
}

TurnedFour turned_to(const ImageView& image, const Ids& ids) {
  std::array<Eigen::Vector2d, 4> rays;
  for (std::size_t k = 0; k < 4; ++k) rays[k] = image[ids[k]].xy / image.focal_px();
  const Eigen::Matrix3d Q = turn_into_sight(rays);
  return {Q, turned(Q, rays)};
}

class FourSearch {
 public:
  FourSearch(std::span<const SearchModel> models,
             const FourIndex& index,
             const ImageView& image,
             std::span<const ImageFour> fours,
             const FourSearchOptions& options)
      : models_(models), index_(index), image_(image), fours_(fours), options_(options) {
    sigma_ = kNoise_px / image.focal_px();
    const double near = options.min_depth_m, far = options.max_depth_m;
    least_size_ = static_cast<float>(2.0 / (far * far) / kDepthSlack);
    most_size_ = static_cast<float>(2.0 / (near * near) * kDepthSlack);
  }

  // Tests the next fours; false when none is left.
  bool next_batch(std::vector<Trial>& trials) {
    trials.clear();
    const std::size_t end = tests_ + batch_;
    batch_ = std::min(2 * batch_, kMostBatch);
    questions_.clear();
    while (next_ < fours_.size() && tests_ < end) ask(next_++);
    answer(trials);
    std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
      return std::tie(a.sigmas, a.model_four, a.image_four, a.order) <
             std::tie(b.sigmas, b.model_four, b.image_four, b.order);
    });
    return next_ < fours_.size();
  }

  bool pose_of(const Trial& trial, RigidPose& pose) const {
    constexpr int kRounds = 3;
    const TurnedFour seen = turned_to(image_, in_order(fours_[trial.image_four], trial.order));
    FourPose solver(models_[model_of(trial)].points, index_[trial.model_four].ids, seen);
    for (int round = 0; round < kRounds; ++round) solver.correct();
    return solver.pose(pose);
  }

  std::uint32_t model_of(const Trial& trial) const { return index_[trial.model_four].model; }

  std::size_t tests() const { return tests_; }

 private:
  static constexpr double kDepthSlack = 1.5;  // the depth is the pool's to judge

  // A four of the image in one order, and the models' fours that it may be.
  struct Question {
    FourIndex::Group group;
    std::uint32_t image_four = 0;
    std::uint8_t order = 0;
    std::uint8_t links = 0;
    TurnedFour seen;
    FourProducts products;
  };

  void ask(std::size_t number) {
    const ImageFour& four = fours_[number];
    const std::span<const std::array<std::uint8_t, 4>> orders = orders_of(four.shape);
    for (std::uint8_t order = 0; order < orders.size(); ++order) {
      const Ids ids = in_order(four, order);
      const FourIndex::Group group = index_.group(
          four.shape, four_signature(ids, [&](std::uint16_t id) { return image_[id].type; }));
      if (group.size == 0) continue;
      tests_ += group.size;
      const TurnedFour seen = turned_to(image_, ids);
      questions_.push_back(
          {group,
           static_cast<std::uint32_t>(number),
           order,
           link_mask(ids, [&](std::uint16_t a, std::uint16_t b) { return image_.linked(a, b); }),
           seen,
           four_products(seen.rays)});
    }
  }

  // Questions of one group together, block by block: what is looked at is then still in the cache.
  void answer(std::vector<Trial>& trials) {
    constexpr std::size_t kBlock = 1024;
    std::stable_sort(
        questions_.begin(), questions_.end(), [](const Question& a, const Question& b) {
          return a.group.first < b.group.first;
        });
    for (std::size_t begin = 0; begin < questions_.size();) {
      const FourIndex::Group group = questions_[begin].group;
      std::size_t end = begin;
      while (end < questions_.size() && questions_[end].group.first == group.first) ++end;
      for (std::size_t at = 0; at < group.size; at += kBlock) {
        const FourIndex::Group block{group.first + at, std::min(kBlock, group.size - at)};
        for (std::size_t i = begin; i < end; ++i) test(questions_[i], block, trials);
      }
      begin = end;
    }
  }

  void test(const Question& question, const FourIndex::Group& block, std::vector<Trial>& trials) {
    hits_.clear();
    test_fours(index_, block, question.products, kTolerance, hits_);
    // Fours lie apart in memory: all of them are fetched while the first one is looked at.
    for (const FourHit& hit : hits_) __builtin_prefetch(&index_[hit.model_four]);
    std::erase_if(hits_, [&](const FourHit& hit) { return !may_be(question, hit); });
    for (std::size_t first = 0; first < hits_.size(); first += FourLanes::kLanes) {
      const std::size_t count = std::min(FourLanes::kLanes, hits_.size() - first);
      look_closer(question, std::span(hits_).subspan(first, count), trials);
    }
  }

  bool may_be(const Question& question, const FourHit& hit) const {
    const ModelFour& model = index_[hit.model_four];
    // What is joined in the image is an edge of the model: an edge may be missed, not made up.
    return (question.links & ~model.links) == 0 && options_.wanted[model.model] &&
           hit.size >= least_size_ && hit.size <= most_size_;
  }

  // At no more hits than there are lanes: at all at once, then at what is left one by one.
  void look_closer(const Question& question,
                   std::span<const FourHit> hits,
                   std::vector<Trial>& trials) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const ModelFour& model = index_[hits[i].model_four];
      const std::vector<PosePoint>& points = models_[model.model].points;
      lanes_.set(i,
                 {&points[model.ids[0]].xyz,
                  &points[model.ids[1]].xyz,
                  &points[model.ids[2]].xyz,
                  &points[model.ids[3]].xyz});
    }
    std::array<std::uint8_t, FourLanes::kLanes> passes;
    screen_fours(lanes_, question.seen.rays, kMostSigmas, sigma_, passes);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (passes[i] == 0) continue;
      const ModelFour& model = index_[hits[i].model_four];
      FourPose solver(models_[model.model].points, model.ids, question.seen);
      if (!model.views[nearest_view(solver.to_camera())]) continue;
      solver.correct();
      const double sigmas = solver.sigmas(sigma_);
      if (sigmas > kMostSigmas) continue;
      trials.push_back({sigmas, hits[i].model_four, question.image_four, question.order});
    }
  }

  std::span<const SearchModel> models_;
  const FourIndex& index_;
  const ImageView& image_;
  std::span<const ImageFour> fours_;
  const FourSearchOptions& options_;
  double sigma_ = 1.0;  // of a ray's coordinate
  float least_size_ = 0.0F, most_size_ = 0.0F;
  std::size_t next_ = 0, tests_ = 0, batch_ = kFirstBatch;
  std::vector<Question> questions_;
  std::vector<FourHit> hits_;
  FourLanes lanes_;
};

// A pose that is worth trying.
struct Shot {
  std::size_t hits = 0;
  std::uint32_t model = 0;
  RigidPose pose;
};

void best_first(std::vector<Shot>& shots) {
  std::stable_sort(
      shots.begin(), shots.end(), [](const Shot& a, const Shot& b) { return a.hits > b.hits; });
}

}  // namespace

bool search_by_fours(std::span<const SearchModel> models,
                     const FourIndex& index,
                     const ImageView& image,
                     std::span<const ImageFour> fours,
                     const FourSearchOptions& options,
                     const RunContext& run,
                     CandidatePool& pool) {
  FourSearch search(models, index, image, fours, options);
  std::vector<Trial> trials;
  std::vector<Shot> shots, later;
  std::size_t counted = 0;
  bool more = true;
  while (more && counted < kMostPoses && search.tests() < kMostTests) {
    run.check("lookup");
    more = search.next_batch(trials);
    run.check("verify");
    shots.clear();
    for (const Trial& trial : trials) {
      Shot shot;
      shot.model = search.model_of(trial);
      if (!search.pose_of(trial, shot.pose)) continue;
      shot.hits = pool.count_near(shot.model, shot.pose);
      if (shot.hits > 0) shots.push_back(shot);
    }
    counted += trials.size();
    best_first(shots);
    for (std::size_t i = 0; i < shots.size(); ++i) {
      if (i < kTriedAtOnce) {
        pool.try_pose(shots[i].model, shots[i].pose);
      } else {
        later.push_back(shots[i]);
      }
    }
    if (pool.beyond_doubt()) return true;
  }
  best_first(later);
  for (std::size_t i = 0; i < std::min(later.size(), kTriedLast); ++i) {
    if (i % kTriedAtOnce == 0) {
      run.check("verify");
      if (pool.beyond_doubt()) return true;
    }
    pool.try_pose(later[i].model, later[i].pose);
  }
  return !more && later.size() <= kTriedLast;
}

}  // namespace landmarkdb
