#include "engine/mono/chance_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace landmarkdb {
namespace {

constexpr double kChanceOfLink = 0.25;      // at most, of two chance matches
constexpr std::size_t kSearched = 3;        // links that the search itself has asked for
constexpr double kLeastChanceOfArm = 0.25;  // edges of real scenes share their directions
constexpr double kDirection_rad = 12.0 * std::numbers::pi / 180.0;

double turned_apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

// How many features of its type a disc of the tolerance holds by chance, summed over the points
// seen: the features in the box around these are taken to be spread over it.
double expected_in_discs(const MonoCandidate& candidate,
                         const SearchModel& model,
                         const ImageView& image,
                         std::span<const std::uint16_t> seen,
                         double reach_px) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  std::array<double, kFeatureTypes> of_type{};
  for (const std::uint16_t id : seen) {
    const Eigen::Vector3d X = candidate.pose * model.points[id].xyz;
    if (!(X.z() > 0.0)) continue;
    low = low.cwiseMin(straight_px(image, X));
    high = high.cwiseMax(straight_px(image, X));
    of_type[static_cast<std::size_t>(model.model().points[id].type)] += 1.0;
  }
  low.array() -= 2.0 * reach_px;
  high.array() += 2.0 * reach_px;
  std::array<double, kFeatureTypes> in_box{};
  for (const ImageView::Point& point : image.points()) {
    if ((point.xy.array() >= low.array()).all() && (point.xy.array() <= high.array()).all()) {
      in_box[point.type] += 1.0;
    }
  }
  double pairs = 0.0;
  for (std::size_t type = 0; type < kFeatureTypes; ++type) pairs += of_type[type] * in_box[type];
  return std::numbers::pi * reach_px * reach_px / (high - low).prod() * pairs;
}

double mean_sigma_px(const MonoCandidate& candidate, const ImageView& image) {
  double sigma_px = 0.0;
  for (const Match& match : candidate.matches) {
    sigma_px += image[match.image].sigma_px / static_cast<double>(candidate.matches.size());
  }
  return sigma_px;
}

// Of the points visible, four fix the pose and the others meet a feature by chance. The nearer the
// hits, the less likely: the best of three radii counts (Moisan and Stival 2004 take the best of
// all), where the features are placed well enough for the smallest one.
double log10_points(const MonoCandidate& candidate,
                    const SearchModel& model,
                    const ImageView& image,
                    std::span<const std::uint16_t> seen,
                    double reach_px,
                    double scale) {
  const double expected = expected_in_discs(candidate, model, image, seen, reach_px);
  const double of_image = kFinal_px * scale / reach_px;
  const std::array<double, 3> radii{1.0, of_image, 0.5 * of_image};
  const double sigma_px = mean_sigma_px(candidate, image);
  const std::size_t trials = seen.size() - std::min<std::size_t>(4, seen.size());
  double tail = 0.0, asked = 0.0, last = 2.0;
  for (const double radius : radii) {
    if (!(radius < last)) continue;  // the model is taken to be exact
    last = radius;
    if (radius < 1.0 && 3.0 * sigma_px > radius * reach_px) continue;
    const std::size_t hits = static_cast<std::size_t>(
        std::count_if(candidate.matches.begin(), candidate.matches.end(), [&](const Match& m) {
          return radius == 1.0 || double{m.distance_px} <= radius * reach_px;
        }));
    if (radius < 1.0 && hits < kLeastHits) continue;
    const double chance =
        1.0 - std::exp(-radius * radius * expected / static_cast<double>(seen.size()));
    asked += 1.0;
    tail = std::min(
        tail,
        log10_binomial_tail(trials, std::max(hits, kLeastHits - 1) - (kLeastHits - 1), chance));
  }
  return std::log10(asked) + tail;
}

// Edges of the model between matched points, and those of them that the image links; edges at
// matched points that are not linked, and those along which a direction of the feature lies.
struct EdgeCounts {
  std::size_t edges = 0, linked = 0, arms = 0, fitting = 0;
  double chance_of_arm = 0.0;  // summed over the arms
};

void count_arm(const ImageView& image,
               const ImageView::Point& at,
               const Eigen::Vector3d& here,
               const Eigen::Vector3d& there,
               EdgeCounts& counts) {
  if (at.directions.empty() || !(there.z() > 0.0)) return;
  const Eigen::Vector2d d = straight_px(image, there) - straight_px(image, here);
  const double direction = std::atan2(d.y(), d.x());
  ++counts.arms;
  counts.chance_of_arm +=
      std::clamp(static_cast<double>(at.directions.size()) * kDirection_rad / std::numbers::pi,
                 kLeastChanceOfArm,
                 0.9);
  const bool fits =
      std::any_of(at.directions.begin(), at.directions.end(), [&](double seen_direction) {
        return turned_apart(seen_direction, direction) < kDirection_rad;
      });
  counts.fitting += fits ? 1 : 0;
}

EdgeCounts count_edges(const MonoCandidate& candidate,
                       const SearchModel& model,
                       const ImageView& image) {
  EdgeCounts counts;
  std::vector<int> image_of(model.points.size(), -1);
  for (const Match& match : candidate.matches) image_of[match.model] = match.image;
  for (const Match& match : candidate.matches) {
    const Eigen::Vector3d here = candidate.pose * model.points[match.model].xyz;
    for (const std::uint32_t other : model.neighbours[match.model]) {
      const int at = image_of[other];
      const bool joined = at >= 0 && image.linked(match.image, static_cast<std::size_t>(at));
      if (at >= 0 && other > match.model) {
        ++counts.edges;
        counts.linked += joined ? 1 : 0;
      }
      if (joined) continue;  // a link lies along the edge: its direction says nothing new
      const Eigen::Vector3d there = candidate.pose * model.points[other].xyz;
      count_arm(image, image[match.image], here, there, counts);
    }
  }
  return counts;
}

std::size_t beyond_searched(std::size_t count) { return count - std::min(count, kSearched); }

}  // namespace

double log10_binomial_tail(std::size_t trials, std::size_t hits, double p) {
  if (hits == 0) return 0.0;
  if (hits > trials || !(p > 0.0)) return -300.0;
  if (p >= 1.0) return 0.0;
  // Terms from `hits` on; each is the last times (n - k) / (k + 1) * p / (1 - p).
  const double n = static_cast<double>(trials), k0 = static_cast<double>(hits);
  const double log_first = std::lgamma(n + 1.0) - std::lgamma(k0 + 1.0) -
                           std::lgamma(n - k0 + 1.0) + k0 * std::log(p) + (n - k0) * std::log1p(-p);
  double sum = 1.0, term = 1.0;
  for (double k = k0; k < n; k += 1.0) {
    term *= (n - k) / (k + 1.0) * p / (1.0 - p);
    sum += term;
  }
  return std::min(0.0, (log_first + std::log(sum)) / std::numbers::ln10);
}

double log10_false_alarms(const MonoCandidate& candidate,
                          const SearchModel& model,
                          const ImageView& image,
                          std::span<const std::uint16_t> seen,
                          double reach_px,
                          const CheckOptions& options) {
  double log10_nfa =
      options.log10_tests + log10_points(candidate, model, image, seen, reach_px, options.scale);
  const EdgeCounts counts = count_edges(candidate, model, image);
  if (image.link_count() > 0 && counts.edges > kSearched) {
    // A point is linked to as many others as on the mean, out of the eight around it.
    const double degree =
        2.0 * static_cast<double>(image.link_count()) / static_cast<double>(image.size());
    const double chance = std::clamp(degree / 8.0, 0.02, kChanceOfLink);
    log10_nfa +=
        log10_binomial_tail(beyond_searched(counts.edges), beyond_searched(counts.linked), chance);
  }
  if (counts.arms > kSearched) {
    log10_nfa += log10_binomial_tail(beyond_searched(counts.arms),
                                     beyond_searched(counts.fitting),
                                     counts.chance_of_arm / static_cast<double>(counts.arms));
  }
  return log10_nfa;
}

}  // namespace landmarkdb
