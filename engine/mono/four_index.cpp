#include "engine/mono/four_index.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "engine/base/parallel.hpp"
#include "engine/base/random.hpp"
#include "engine/mono/quad_code.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

using Ids = std::array<std::uint16_t, 4>;

// Thickness against length (singular values of the differences): of a flatter four a pixel of noise
// says how deep it is. By landmarkdb-bench-mono (seed 11) nine in ten scenes of 6 to 9 true
// features have a thicker one.
constexpr double kLeastThickness = 0.08;
constexpr std::size_t kMostFours = 20000;  // of a model
constexpr double kFlatShare = 0.35;        // of bodies it is a quarter, of boxes 43 in 100
constexpr double kNextView = 0.9659258;    // 15 degrees: views are 11 apart

constexpr std::array<std::array<std::uint8_t, 4>, 2> kPathOrders{{{0, 1, 2, 3}, {3, 2, 1, 0}}};
constexpr std::array<std::array<std::uint8_t, 4>, 6> kStarOrders{
    {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 1, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {0, 3, 2, 1}}};

// Each view with those next to it.
const std::array<std::bitset<kModelViews>, kModelViews>& next_views() {
  static const auto table = [] {
    std::array<std::bitset<kModelViews>, kModelViews> next;
    const auto& views = model_views();
    for (std::size_t i = 0; i < kModelViews; ++i) {
      for (std::size_t j = 0; j < kModelViews; ++j) next[i][j] = views[i].dot(views[j]) > kNextView;
    }
    return next;
  }();
  return table;
}

// By point: the views in which it is seen, and those next to them.
std::vector<std::bitset<kModelViews>> views_of_points(const SearchModel& search) {
  std::vector<std::bitset<kModelViews>> views(search.points.size());
  for (std::size_t view = 0; view < kModelViews; ++view) {
    for (const std::uint16_t id : search.seen[view]) views[id] |= next_views()[view];
  }
  return views;
}

Eigen::Matrix3d differences(const SearchModel& search, const Ids& ids) {
  Eigen::Matrix3d E;
  for (std::size_t k = 1; k < 4; ++k) {
    E.row(static_cast<Eigen::Index>(k - 1)) = search.points[ids[k]].xyz - search.points[ids[0]].xyz;
  }
  return E;
}

// By the squares of the singular values, in closed form (Smith 1961): models have thousands of
// fours.
bool is_thick(const Eigen::Matrix3d& E) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares;
  squares.computeDirect(E * E.transpose(), Eigen::EigenvaluesOnly);
  return squares.eigenvalues()(0) > kLeastThickness * kLeastThickness * squares.eigenvalues()(2);
}

Ids ids_of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {static_cast<std::uint16_t>(a),
          static_cast<std::uint16_t>(b),
          static_cast<std::uint16_t>(c),
          static_cast<std::uint16_t>(d)};
}

// Leaves an even sample of kMostFours, in their order.
void thin(std::vector<ModelFour>& fours) {
  if (fours.size() <= kMostFours) return;
  const double chance = static_cast<double>(kMostFours) / static_cast<double>(fours.size());
  Random random(kMostFours);
  std::erase_if(fours, [&](const ModelFour&) { return random.uniform() >= chance; });
}

class Collector {
 public:
  Collector(const SearchModel& search, std::uint32_t number)
      : search_(search), number_(number), views_(views_of_points(search)) {}

  void add(FourShape shape, const Ids& ids) {
    const auto type_of = [&](std::uint16_t id) { return search_.model().points[id].type; };
    ModelFour four{.model = number_, .shape = shape};
    unsigned least = 256;
    for (const std::array<std::uint8_t, 4>& order : orders_of(shape)) {
      const Ids turned{ids[order[0]], ids[order[1]], ids[order[2]], ids[order[3]]};
      const unsigned signature = four_signature(turned, type_of);
      if (signature >= least) continue;
      least = signature;
      four.ids = turned;
    }
    four.views = views_[ids[0]] & views_[ids[1]] & views_[ids[2]] & views_[ids[3]];
    if (four.views.none()) return;
    if (!is_thick(differences(search_, four.ids))) {
      ++found.flat;
      return;
    }
    four.links =
        link_mask(four.ids, [&](std::uint16_t a, std::uint16_t b) { return search_.linked(a, b); });
    found.fours.push_back(four);
  }

  ModelFours found;

 private:
  const SearchModel& search_;
  std::uint32_t number_;
  std::vector<std::bitset<kModelViews>> views_;
};

}  // namespace

std::span<const std::array<std::uint8_t, 4>> orders_of(FourShape shape) {
  if (shape == FourShape::kPath) return kPathOrders;
  return kStarOrders;
}

ModelFours fours_of(const SearchModel& search, std::uint32_t number) {
  Collector collector(search, number);
  const std::uint32_t n = static_cast<std::uint32_t>(search.points.size());
  for (std::uint32_t b = 0; b < n; ++b) {
    const std::vector<std::uint32_t>& around = search.neighbours[b];
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          collector.add(FourShape::kStar, ids_of(b, around[i], around[j], around[k]));
        }
      }
      const std::uint32_t c = around[i];
      if (c < b) continue;  // each path once, by its middle
      for (const std::uint32_t a : around) {
        for (const std::uint32_t d : search.neighbours[c]) {
          if (a != c && d != b && a != d) collector.add(FourShape::kPath, ids_of(a, b, c, d));
        }
      }
    }
  }
  thin(collector.found.fours);
  return std::move(collector.found);
}

FourIndex::FourIndex(std::span<const SearchModel> models, int threads) {
  std::vector<ModelFours> parts(models.size());
  parallel_chunks(models.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parts[i] = fours_of(models[i], static_cast<std::uint32_t>(i));
    }
  });
  for (const ModelFours& part : parts) {
    const double all = static_cast<double>(part.fours.size() + part.flat);
    often_flat_.push_back(static_cast<double>(part.flat) >= kFlatShare * all);
  }
  const auto group_of = [&](const ModelFour& four) -> Group& {
    const SearchModel& search = models[four.model];
    const std::uint8_t signature =
        four_signature(four.ids, [&](std::uint16_t id) { return search.model().points[id].type; });
    return groups_[static_cast<std::size_t>(four.shape) * 256 + signature];
  };
  for (const ModelFours& part : parts) {
    for (const ModelFour& four : part.fours) ++group_of(four).size;
  }
  std::size_t total = 0;
  for (Group& group : groups_) {
    group.first = total;
    group.size = (group.size + kLanes - 1) / kLanes * kLanes;
    total += group.size;
  }
  fours_.resize(total);
  for (std::vector<float>& plane : metric_) plane.assign(total, 0.0F);
  std::array<std::size_t, 512> filled{};
  for (const ModelFours& part : parts) {
    for (const ModelFour& four : part.fours) {
      const Group& group = group_of(four);
      const std::size_t at = group.first + filled[static_cast<std::size_t>(&group - &groups_[0])]++;
      fours_[at] = four;
      const Eigen::Matrix3d E = differences(models[four.model], four.ids);
      const Eigen::Matrix3d G = (E * E.transpose()).inverse();
      constexpr std::array<std::array<int, 2>, 6> kElements{
          {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
      for (std::size_t k = 0; k < 6; ++k) {
        metric_[k][at] = static_cast<float>(G(kElements[k][0], kElements[k][1]));
      }
    }
  }
}

}  // namespace landmarkdb
