#include "engine/mono/choose_quads.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/mono/quad_code.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

// Chosen on generated models (landmarkdb-bench-mono): more find hardly more.
constexpr std::size_t kQuadsAView = 60;    // of models without edges
constexpr std::size_t kChainsAView = 120;  // with three edges or more among the four points
constexpr std::size_t kPairsAView = 30;    // with two
constexpr double kShortest = 0.25, kLongest = 0.8;  // of AB, in model diameters
constexpr std::size_t kLinks = 2;                   // edges among the four points
constexpr std::size_t kMostSubsets = 20000;         // of four points of a model that are looked at

using Image = std::vector<Eigen::Vector2d>;  // a view: where each point lies, metres

std::uint64_t hash_of(const PointFour& s) {
  return Random((std::uint64_t{s[0]} << 48U) ^ (std::uint64_t{s[1]} << 32U) ^
                (std::uint64_t{s[2]} << 16U) ^ s[3])
      .next();
}

// Which pairs of points an edge joins.
class Links {
 public:
  explicit Links(const MonoModel& model)
      : points_(model.points.size()), joined_(points_ * points_, 0) {
    for (const auto& [a, b] : model.edges) joined_[a * points_ + b] = joined_[b * points_ + a] = 1;
  }
  bool operator()(std::size_t a, std::size_t b) const { return joined_[a * points_ + b] != 0; }

 private:
  std::size_t points_;
  std::vector<char> joined_;
};

std::vector<std::pair<std::uint64_t, PointFour>> by_hash(std::vector<PointFour> all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<std::pair<std::uint64_t, PointFour>> hashed;
  hashed.reserve(all.size());
  for (const PointFour& s : all) hashed.emplace_back(hash_of(s), s);
  return hashed;
}

// All fours with two edges among them: pairs of edges, and a fourth point where these share one.
std::vector<PointFour> linked_subsets(const MonoModel& model) {
  std::vector<PointFour> all;
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [a, b] = model.edges[i];
      const auto& [c, d] = model.edges[j];
      const bool meet = a == c || a == d || b == c || b == d;
      if (!meet) {
        add_four(a, b, c, d, all);
        continue;
      }
      const std::uint32_t other = c == a || c == b ? d : c;
      for (std::uint32_t p = 0; p < model.points.size(); ++p) add_four(a, b, other, p, all);
    }
  }
  return all;
}

// Without edges: each pair with the nine points that lie nearest to its middle within its circle,
// as the image's side looks at them; of these as many as a view keeps, by hash.
std::vector<std::pair<std::uint64_t, PointFour>> free_subsets(std::span<const std::uint16_t> seen,
                                                              const Image& at) {
  std::vector<PointFour> all;
  std::vector<std::pair<double, std::uint16_t>> inside;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d middle = 0.5 * (at[seen[i]] + at[seen[j]]);
      const double reach = 0.25 * (at[seen[i]] - at[seen[j]]).squaredNorm();
      inside.clear();
      for (const std::uint16_t id : seen) {
        if (id == seen[i] || id == seen[j]) continue;
        const double d2 = (at[id] - middle).squaredNorm();
        if (d2 <= reach) inside.emplace_back(d2, id);
      }
      const std::size_t kept = std::min(inside.size(), kNearMiddle);
      std::partial_sort(
          inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(kept), inside.end());
      for (std::size_t c = 0; c < kept; ++c) {
        for (std::size_t d = 0; d < c; ++d) {
          add_four(seen[i], seen[j], inside[c].second, inside[d].second, all);
        }
      }
    }
  }
  std::vector<std::pair<std::uint64_t, PointFour>> hashed = by_hash(std::move(all));
  const std::size_t most = std::min(hashed.size(), 4 * kQuadsAView);  // some are cramped or short
  std::partial_sort(
      hashed.begin(), hashed.begin() + static_cast<std::ptrdiff_t>(most), hashed.end());
  hashed.resize(most);
  return hashed;
}

class Chooser {
 public:
  Chooser(const MonoModel& model, std::span<const ViewMask> seen) : model_(model), seen_(seen) {
    const Eigen::Vector3d center = mean_point(model);
    for (std::size_t view = 0; view < kModelViews; ++view) {
      const Eigen::Matrix<double, 2, 3> axes = image_axes(model_views()[view]);
      for (const ModelFeature& point : model.points) {
        images_[view].push_back(axes * (point.xyz - center));
      }
    }
  }

  std::vector<ChosenQuad> linked() const {
    const Links links(model_);
    auto hashed = by_hash(linked_subsets(model_));
    std::sort(hashed.begin(), hashed.end());
    struct Kind {
      std::size_t most_a_view, looked_at = 0, full_views = 0;
      std::array<std::size_t, kModelViews> kept{};
    };
    std::array<Kind, 2> kinds{Kind{kPairsAView}, Kind{kChainsAView}};
    std::vector<ChosenQuad> result;
    for (const auto& [hash, s] : hashed) {
      Kind& kind = kinds[std::popcount(link_mask(s, links)) >= 3 ? 1 : 0];
      if (kind.looked_at++ >= kMostSubsets || kind.full_views == kModelViews) continue;
      ChosenQuad quad{s, {}};
      const ViewMask seen = seen_[s[0]] & seen_[s[1]] & seen_[s[2]] & seen_[s[3]];
      if (seen.none()) continue;
      for (std::size_t view = 0; view < kModelViews; ++view) {
        if (!seen[view] || kind.kept[view] == kind.most_a_view || !is_good(view, s)) continue;
        quad.views.set(view);
        if (++kind.kept[view] == kind.most_a_view) ++kind.full_views;
      }
      if (quad.views.any()) result.push_back(quad);
    }
    return result;
  }

  std::vector<ChosenQuad> unlinked() const {
    std::map<std::pair<std::uint64_t, PointFour>, ViewMask> chosen;
    std::vector<std::uint16_t> ids;
    for (std::size_t view = 0; view < kModelViews; ++view) {
      ids.clear();
      for (std::size_t i = 0; i < seen_.size(); ++i) {
        if (seen_[i][view]) ids.push_back(static_cast<std::uint16_t>(i));
      }
      std::size_t kept = 0;
      for (const auto& subset : free_subsets(ids, images_[view])) {
        if (kept == kQuadsAView) break;
        if (!is_good(view, subset.second)) continue;
        chosen[subset].set(view);
        ++kept;
      }
    }
    std::vector<ChosenQuad> result;
    for (const auto& [subset, views] : chosen) result.push_back({subset.second, views});
    return result;
  }

 private:
  bool is_good(std::size_t view, const PointFour& s) const {
    const Image& at = images_[view];
    QuadCode code;
    if (!code_quad({at[s[0]], at[s[1]], at[s[2]], at[s[3]]}, code)) return false;
    const double length_m = (at[s[code.order[1]]] - at[s[code.order[0]]]).norm();
    return length_m >= kShortest * model_.diameter_m && length_m <= kLongest * model_.diameter_m;
  }

  const MonoModel& model_;
  std::span<const ViewMask> seen_;
  std::array<Image, kModelViews> images_;
};

}  // namespace

bool is_linked(const MonoModel& model) { return model.edges.size() >= kLinks; }

Eigen::Vector3d mean_point(const MonoModel& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ModelFeature& point : model.points) sum += point.xyz;
  return sum / std::max<double>(1.0, static_cast<double>(model.points.size()));
}

Eigen::Matrix<double, 2, 3> image_axes(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d up =
      std::abs(direction.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d z = -direction;
  const Eigen::Vector3d x = z.cross(up).normalized();
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = x;
  axes.row(1) = z.cross(x);
  return axes;
}

std::vector<ChosenQuad> choose_quads(const MonoModel& model, std::span<const ViewMask> seen) {
  if (model.points.size() < 4) return {};
  const Chooser chooser(model, seen);
  return is_linked(model) ? chooser.linked() : chooser.unlinked();
}

std::string quad_choice_params() {
  std::ostringstream text;
  text << "views=" << kModelViews << " free=" << kQuadsAView << " chains=" << kChainsAView
       << " pairs=" << kPairsAView << " shortest=" << kShortest << " longest=" << kLongest
       << " links=" << kLinks << " subsets=" << kMostSubsets << " middle=" << kNearMiddle;
  return text.str();
}

}  // namespace landmarkdb
