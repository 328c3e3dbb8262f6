#include "engine/mono/four_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include <Eigen/LU>

#include "engine/mono/four_metric.hpp"
#include "engine/mono/line_of_sight.hpp"
#include "engine/mono/quad_code.hpp"

namespace landmarkdb {
namespace {

using Ids = std::array<std::uint16_t, 4>;
using Four = std::array<Eigen::Vector2d, 4>;

// Of |w^T G w| against w^H G w, before perspective is corrected. On generated scenes (100 models,
// seed 11, 0.5 to 1.2 m, 1 px of noise) nine in ten true fours are below.
constexpr float kTolerance = 0.15F;
// And after it, in sigmas of what noise makes of it: 90 in 100 are below, and of 98 in 100 scenes
// one below 1.05; a tenth of the others.
constexpr double kMostSigmas = 1.6;
constexpr double kNoise_px = 1.0;  // of a feature: the search's, whatever the features say
// Pairs tested in one go, some nanoseconds each: at first few, as often one of the first fours is
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

struct Turned {
  Eigen::Matrix3d Q;  // turns the camera towards the four
  Four rays;
};

Turned turned_to(const ImageView& image, const Ids& ids) {
  Four rays;
  for (std::size_t k = 0; k < 4; ++k) rays[k] = image[ids[k]].xy / image.focal_px();
  const Eigen::Matrix3d Q = turn_into_sight(rays);
  return {Q, turned(Q, rays)};
}

// A four of a model as an image's four shows it: scaled orthography about the first point, in the
// camera that is turned to it, with perspective correction (DeMenthon & Davis 1995).
class FourPose {
 public:
  FourPose(const SearchModel& search, const Ids& model, const Turned& seen)
      : seen_(seen), origin_(search.points[model[0]].xyz) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      E_.row(k) = search.points[model[static_cast<std::size_t>(k) + 1]].xyz - origin_;
    }
    inverse_ = E_.inverse();
    fit(Eigen::Vector3d::Ones());
  }

  // Where the camera is, in the object frame; of any length.
  Eigen::Vector3d to_camera() const { return -L_.col(0).cross(L_.col(1)); }

  // One round of perspective correction, with the depths that the map has now.
  void correct() {
    const double size = std::sqrt(0.5 * L_.squaredNorm());  // 1 / s
    fit(Eigen::Vector3d::Ones() + size * (E_ * -to_camera().normalized()));
  }

  // How far the map's two rows are from orthogonal and equally long, in sigmas of what noise of
  // `sigma` (of a ray's coordinate) makes of that.
  double sigmas(double sigma) const {
    const double across = L_.col(0).squaredNorm() - L_.col(1).squaredNorm();
    const double off = std::hypot(across, 2.0 * L_.col(0).dot(L_.col(1)));
    return off / (2.0 * std::numbers::sqrt2 * sigma * (inverse_.transpose() * L_).norm());
  }

  // The nearest rotation to the map's rows; false where there is none.
  bool pose(RigidPose& result) const {
    const Eigen::Matrix2d M = L_.transpose() * L_;
    const double root = std::sqrt(std::max(0.0, M.determinant()));
    const double trace = std::sqrt(M.trace() + 2.0 * root);  // of M^(1/2)
    if (!(root > 0.0) || !std::isfinite(trace)) return false;
    Eigen::Matrix2d G = M;
    G.diagonal().array() += root;
    const Eigen::Matrix<double, 2, 3> rows = trace * G.inverse() * L_.transpose();
    Eigen::Matrix3d R;
    R << rows, rows.row(0).cross(rows.row(1));
    const Eigen::Vector3d t = 2.0 / trace * seen_.rays[0].homogeneous() - R * origin_;
    result = {seen_.Q.transpose() * R, seen_.Q.transpose() * t};
    return result.t.allFinite();
  }

 private:
  // `nearer`: 1 + e_i, by how much points 1 to 3 are further away than point 0.
  void fit(const Eigen::Vector3d& nearer) {
    Eigen::Matrix<double, 3, 2> w;
    for (Eigen::Index k = 0; k < 3; ++k) {
      w.row(k) = seen_.rays[static_cast<std::size_t>(k) + 1] * nearer(k) - seen_.rays[0];
    }
    L_ = inverse_ * w;
  }

  const Turned& seen_;
  Eigen::Vector3d origin_;
  Eigen::Matrix3d E_, inverse_;
  Eigen::Matrix<double, 3, 2> L_;  // the first two rows of the rotation over the depth
};

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
    while (next_ < fours_.size() && tests_ < end) test(next_++, trials);
    std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
      return std::tie(a.sigmas, a.model_four, a.image_four, a.order) <
             std::tie(b.sigmas, b.model_four, b.image_four, b.order);
    });
    return next_ < fours_.size();
  }

  bool pose_of(const Trial& trial, RigidPose& pose) const {
    constexpr int kRounds = 3;
    const Turned seen = turned_to(image_, in_order(fours_[trial.image_four], trial.order));
    FourPose solver(models_[model_of(trial)], index_[trial.model_four].ids, seen);
    for (int round = 0; round < kRounds; ++round) solver.correct();
    return solver.pose(pose);
  }

  std::uint32_t model_of(const Trial& trial) const { return index_[trial.model_four].model; }

  std::size_t tests() const { return tests_; }

 private:
  static constexpr double kDepthSlack = 1.5;  // the depth is the pool's to judge

  void test(std::size_t number, std::vector<Trial>& trials) {
    const ImageFour& four = fours_[number];
    const std::span<const std::array<std::uint8_t, 4>> orders = orders_of(four.shape);
    for (std::uint8_t order = 0; order < orders.size(); ++order) {
      const Ids ids = in_order(four, order);
      const FourIndex::Group group = index_.group(
          four.shape, four_signature(ids, [&](std::uint16_t id) { return image_[id].type; }));
      if (group.size == 0) continue;
      tests_ += group.size;
      const Turned seen = turned_to(image_, ids);
      hits_.clear();
      test_fours(index_, group, four_products(seen.rays), kTolerance, hits_);
      // What is joined in the image is an edge of the model: an edge may be missed, not made up.
      const std::uint8_t links =
          link_mask(ids, [&](std::uint16_t a, std::uint16_t b) { return image_.linked(a, b); });
      constexpr std::size_t kAhead = 8;  // fours lie apart in memory: they are fetched in time
      for (std::size_t i = 0; i < hits_.size(); ++i) {
        if (i + kAhead < hits_.size()) __builtin_prefetch(&index_[hits_[i + kAhead].model_four]);
        const FourHit& hit = hits_[i];
        const ModelFour& model = index_[hit.model_four];
        if ((links & ~model.links) != 0 || !options_.wanted[model.model] ||
            hit.size < least_size_ || hit.size > most_size_) {
          continue;
        }
        FourPose solver(models_[model.model], model.ids, seen);
        if (!model.views[nearest_view(solver.to_camera())]) continue;
        solver.correct();
        const double sigmas = solver.sigmas(sigma_);
        if (sigmas > kMostSigmas) continue;
        trials.push_back({sigmas, hit.model_four, static_cast<std::uint32_t>(number), order});
      }
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
  std::vector<FourHit> hits_;
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
