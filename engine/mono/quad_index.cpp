#include "engine/mono/quad_index.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>

#include "engine/base/parallel.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// Chosen on generated models (landmarkdb-bench-mono): more find hardly more.
constexpr std::size_t kQuadsAView = 60;    // of models without edges
constexpr std::size_t kChainsAView = 120;  // with three edges or more among the four points
constexpr std::size_t kPairsAView = 30;    // with two
constexpr double kShortest = 0.25, kLongest = 0.8;  // of AB, in model diameters
constexpr std::size_t kLinks = 2;                   // edges among the four points
constexpr std::size_t kMostSubsets = 20000;         // of four points of a model that are looked at

using Subset = std::array<std::uint16_t, 4>;

std::uint64_t hash_of(const Subset& s) {
  return Random((std::uint64_t{s[0]} << 48U) ^ (std::uint64_t{s[1]} << 32U) ^
                (std::uint64_t{s[2]} << 16U) ^ s[3])
      .next();
}

void add_subset(
    std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::vector<Subset>& all) {
  Subset s{static_cast<std::uint16_t>(a),
           static_cast<std::uint16_t>(b),
           static_cast<std::uint16_t>(c),
           static_cast<std::uint16_t>(d)};
  std::sort(s.begin(), s.end());
  if (std::adjacent_find(s.begin(), s.end()) == s.end()) all.push_back(s);
}

struct LinkedSubset {
  Subset ids{};
  bool chain = false;  // three edges among them
};

// All fours with two edges among them (pairs of edges, and a fourth point where these share one),
// by hash: neighbouring views then keep the same ones.
std::vector<LinkedSubset> linked_subsets(const SearchModel& search) {
  const MonoModel& model = search.model();
  std::vector<Subset> all;
  for (std::size_t i = 0; i < model.edges.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [a, b] = model.edges[i];
      const auto& [c, d] = model.edges[j];
      const bool meet = a == c || a == d || b == c || b == d;
      if (!meet) {
        add_subset(a, b, c, d, all);
        continue;
      }
      const std::uint32_t other = c == a || c == b ? d : c;
      for (std::uint32_t p = 0; p < model.points.size(); ++p) add_subset(a, b, other, p, all);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::sort(all.begin(), all.end(), [](const Subset& a, const Subset& b) {
    return std::pair(hash_of(a), a) < std::pair(hash_of(b), b);
  });
  std::vector<LinkedSubset> result;
  std::array<std::size_t, 2> kept{};
  for (const Subset& s : all) {
    const std::uint8_t mask =
        link_mask(s, [&](std::uint16_t a, std::uint16_t b) { return search.linked(a, b); });
    const bool chain = std::popcount(mask) >= 3;
    if (kept[chain ? 1 : 0]++ < kMostSubsets) result.push_back({s, chain});
  }
  return result;
}

// Without edges: each pair with the nine points that lie nearest to its middle within its circle,
// as the image's side looks at them; of these as many as a view keeps, by hash.
std::vector<Subset> free_subsets(std::span<const std::uint16_t> seen,
                                 const std::vector<Eigen::Vector2d>& at) {
  std::vector<std::pair<std::uint64_t, Subset>> all;
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
          Subset s{seen[i], seen[j], inside[c].second, inside[d].second};
          std::sort(s.begin(), s.end());
          all.emplace_back(hash_of(s), s);
        }
      }
    }
  }
  const std::size_t most = std::min(all.size(), 4 * kQuadsAView);  // some are cramped or too short
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(most), all.end());
  std::vector<Subset> result;
  for (std::size_t i = 0; i < most; ++i) result.push_back(all[i].second);
  return result;
}

// Axes of a camera that looks against `direction`: x right, y down, rows.
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

bool add_quad(const SearchModel& search,
              std::uint32_t number,
              std::size_t view,
              const Subset& s,
              const std::vector<Eigen::Vector2d>& at,
              std::vector<ModelQuad>& quads) {
  QuadCode code;
  if (!code_quad({at[s[0]], at[s[1]], at[s[2]], at[s[3]]}, code)) return false;
  const MonoModel& model = search.model();
  ModelQuad quad;
  for (std::size_t k = 0; k < 4; ++k) {
    quad.ids[k] = s[code.order[k]];
    quad.signature = static_cast<std::uint8_t>(
        quad.signature | (static_cast<unsigned>(model.points[quad.ids[k]].type) << (2 * k)));
  }
  const Eigen::Vector2d AB = at[quad.ids[1]] - at[quad.ids[0]];
  const double length = AB.norm();
  if (length < kShortest * model.diameter_m || length > kLongest * model.diameter_m) return false;
  quad.model = number;
  quad.view = static_cast<std::uint8_t>(view);
  quad.links =
      link_mask(quad.ids, [&](std::uint16_t a, std::uint16_t b) { return search.linked(a, b); });
  quad.code = code.code;
  quad.length_m = static_cast<float>(length);
  const Eigen::Vector2d origin =
      QuadFrame(at[quad.ids[0]], at[quad.ids[1]])(Eigen::Vector2d::Zero());
  quad.origin_x = static_cast<float>(origin.x());
  quad.origin_y = static_cast<float>(origin.y());
  quad.angle_rad = static_cast<float>(std::atan2(AB.y(), AB.x()));
  quads.push_back(quad);
  return true;
}

}  // namespace

bool is_linked(const MonoModel& model) { return model.edges.size() >= kLinks; }

std::vector<ModelQuad> quads_of(const SearchModel& search, std::uint32_t number) {
  const MonoModel& model = search.model();
  std::vector<ModelQuad> quads;
  if (model.points.size() < 4) return quads;
  const bool linked = is_linked(model);
  const std::vector<LinkedSubset> subsets =
      linked ? linked_subsets(search) : std::vector<LinkedSubset>();
  std::vector<char> seen(model.points.size());
  std::vector<Eigen::Vector2d> at(model.points.size());
  for (std::size_t view = 0; view < kModelViews; ++view) {
    if (search.seen[view].size() < 4) continue;
    std::fill(seen.begin(), seen.end(), 0);
    const Eigen::Matrix<double, 2, 3> axes = image_axes(model_views()[view]);
    for (const std::uint16_t id : search.seen[view]) {
      seen[id] = 1;
      at[id] = axes * (model.points[id].xyz - search.center);
    }
    if (!linked) {
      std::size_t kept = 0;
      for (const Subset& s : free_subsets(search.seen[view], at)) {
        if (kept < kQuadsAView && add_quad(search, number, view, s, at, quads)) ++kept;
      }
      continue;
    }
    std::array<std::size_t, 2> kept{};
    for (const LinkedSubset& s : subsets) {
      std::size_t& count = kept[s.chain ? 1 : 0];
      if (count == (s.chain ? kChainsAView : kPairsAView)) continue;
      if (!seen[s.ids[0]] || !seen[s.ids[1]] || !seen[s.ids[2]] || !seen[s.ids[3]]) continue;
      if (add_quad(search, number, view, s.ids, at, quads)) ++count;
    }
  }
  return quads;
}

QuadIndex::QuadIndex(std::span<const SearchModel> models, int threads) {
  std::vector<std::vector<ModelQuad>> parts(models.size());
  parallel_chunks(models.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parts[i] = quads_of(models[i], static_cast<std::uint32_t>(i));
    }
  });
  std::array<bool, 256> used{};
  std::size_t total = 0;
  for (const std::vector<ModelQuad>& part : parts) {
    total += part.size();
    for (const ModelQuad& quad : part) used[quad.signature] = true;
  }
  std::size_t blocks = 0;
  for (std::size_t s = 0; s < used.size(); ++s) {
    block_of_[s] = used[s] ? static_cast<std::int32_t>(blocks++) : -1;
  }
  // A counting sort by cell; within a cell the order of models and views stays.
  starts_.assign(blocks * (kBlock + 1) + 1, 0);
  const auto slot = [&](const ModelQuad& quad) {
    return static_cast<std::size_t>(block_of_[quad.signature]) * (kBlock + 1) +
           ((cell(quad.code[0]) * kCells + cell(quad.code[1])) * kCells + cell(quad.code[2])) *
               kCells +
           cell(quad.code[3]);
  };
  for (const std::vector<ModelQuad>& part : parts) {
    for (const ModelQuad& quad : part) ++starts_[slot(quad) + 1];
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  quads_.resize(total);
  std::vector<std::uint32_t> next = starts_;
  for (const std::vector<ModelQuad>& part : parts) {
    for (const ModelQuad& quad : part) quads_[next[slot(quad)]++] = quad;
  }
}

}  // namespace landmarkdb
