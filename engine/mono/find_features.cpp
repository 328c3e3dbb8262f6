#include "engine/mono/find_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/mono/edge_chains.hpp"
#include "engine/mono/edge_points.hpp"
#include "engine/mono/find_vertices.hpp"
#include "engine/mono/fit_chains.hpp"
#include "engine/mono/straight_lens.hpp"

namespace landmarkdb {
namespace {

void check_input(const GreyImage& image, const FeatureSearchOptions& options) {
  if (image.pixels.size() != std::size_t{image.width} * image.height) {
    throw Error(ErrorCode::kInvalidArgument,
                "image: " + std::to_string(image.pixels.size()) + " pixels, want " +
                    std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  if (options.camera &&
      (options.camera->width != image.width || options.camera->height != image.height)) {
    throw Error(ErrorCode::kInvalidArgument,
                "image: " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                    " pixels, but the camera is for " + std::to_string(options.camera->width) +
                    " x " + std::to_string(options.camera->height));
  }
}

// Keeps the `most` largest by `size`, in their order.
template <typename T, typename Size>
void keep_largest(std::vector<T>& items, std::size_t most, const Size& size) {
  if (items.size() <= most) return;
  std::vector<std::size_t> order(items.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return size(items[a]) > size(items[b]);
  });
  order.resize(most);
  std::sort(order.begin(), order.end());
  std::vector<T> kept;
  kept.reserve(most);
  for (const std::size_t i : order) kept.push_back(std::move(items[i]));
  items = std::move(kept);
}

// The chains where the lens does not bend; points that its model does not reach are left out.
EdgeChains straightened(const EdgeChains& chains, const StraightLens& lens) {
  EdgeChains straight;
  straight.points.reserve(chains.points.size());
  for (const EdgeChain& chain : chains.chains) {
    EdgeChain moved{static_cast<std::uint32_t>(straight.points.size()), 0, chain.closed};
    for (std::uint32_t i = chain.begin; i < chain.end; ++i) {
      EdgePoint point = chains.points[i];
      if (lens.straighten(point)) straight.points.push_back(point);
    }
    moved.end = static_cast<std::uint32_t>(straight.points.size());
    if (moved.end - moved.begin >= 3) straight.chains.push_back(moved);
  }
  return straight;
}

struct RankedFeature {
  ImageFeature feature;
  double strength = 0.0;  // px of edge behind it
};

class FeatureList {
 public:
  explicit FeatureList(const StraightLens& lens) : lens_(lens) {}

  void add(FeatureType type,
           const Eigen::Vector2d& at,
           const std::vector<double>& directions,
           double sigma_px,
           double strength) {
    constexpr double kWorst_px = 3.0;  // vaguer places match anything
    const std::uint32_t index = next_++;
    ImageFeature feature{type, lens_.bend(at), {}, sigma_px};
    if (!(sigma_px <= kWorst_px) || !feature.uv.allFinite()) return;
    for (const double angle : directions) {
      feature.directions.push_back(lens_.bend_direction(at, angle));
    }
    features_.push_back({std::move(feature), strength});
    index_.push_back(index);
  }

  // Strongest first, at most `most`; `links` speak of the vertices in the order they were added.
  void move_to(ImageFeatures& out,
               std::size_t most,
               const std::vector<std::array<std::uint32_t, 2>>& links) {
    constexpr std::uint32_t kGone = ~0U;
    std::vector<std::size_t> order(features_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return features_[a].strength > features_[b].strength;
    });
    if (order.size() > most) order.resize(most);
    std::vector<std::uint32_t> place(next_, kGone);
    for (const std::size_t i : order) {
      place[index_[i]] = static_cast<std::uint32_t>(out.points.size());
      out.points.push_back(std::move(features_[i].feature));
    }
    for (const auto& [a, b] : links) {
      if (place[a] == kGone || place[b] == kGone) continue;
      out.links.push_back({std::min(place[a], place[b]), std::max(place[a], place[b])});
    }
    std::sort(out.links.begin(), out.links.end());
  }

 private:
  const StraightLens& lens_;
  std::vector<RankedFeature> features_;
  std::vector<std::uint32_t> index_;  // of each feature among all that were offered
  std::uint32_t next_ = 0;
};

ImageEllipse bent(const StraightLens& lens, ImageEllipse ellipse) {
  if (!lens.active()) return ellipse;
  const Eigen::Vector2d center = ellipse.center;
  const Eigen::Vector2d major(std::cos(ellipse.angle_rad), std::sin(ellipse.angle_rad));
  const Eigen::Vector2d minor(-major.y(), major.x());
  const auto span_of = [&](const Eigen::Vector2d& axis) {
    return Eigen::Vector2d(lens.bend(center + axis) - lens.bend(center - axis));
  };
  const Eigen::Vector2d along = span_of(ellipse.major_px * major);
  ellipse.minor_px = 0.5 * span_of(ellipse.minor_px * minor).norm();
  ellipse.major_px = 0.5 * along.norm();
  ellipse.angle_rad = std::atan2(along.y(), along.x());
  ellipse.center = lens.bend(center);
  return ellipse;
}

// One circle often gives several ellipses: a printed rim both of its edges, a sharpened image a
// halo. Of those about one centre the one with the most edge behind it stays.
void drop_concentric(std::vector<FittedEllipse>& ellipses) {
  constexpr double kSame = 0.15;  // of the axes' mean
  constexpr double kLeast_px = 1.5;
  const auto edge_of = [](const FittedEllipse& e) {
    return e.fit.ellipse.arc_rad * (e.fit.ellipse.major_px + e.fit.ellipse.minor_px);
  };
  std::stable_sort(ellipses.begin(), ellipses.end(), [&](const auto& a, const auto& b) {
    return edge_of(a) > edge_of(b);
  });
  std::vector<FittedEllipse> kept;
  for (const FittedEllipse& e : ellipses) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const FittedEllipse& other) {
      const ImageEllipse &a = e.fit.ellipse, &b = other.fit.ellipse;
      const double reach = std::max(kLeast_px, kSame * 0.5 * (a.major_px + a.minor_px));
      return (a.center - b.center).norm() < reach && a.major_px > 0.5 * b.minor_px;
    });
    if (!known) kept.push_back(e);
  }
  ellipses = std::move(kept);
}

void add_ellipses(const ChainFits& fits,
                  const StraightLens& lens,
                  FeatureList& list,
                  ImageFeatures& out) {
  for (const FittedEllipse& found : fits.ellipses) {
    const ImageEllipse& e = found.fit.ellipse;
    out.ellipses.push_back(bent(lens, e));
    list.add(FeatureType::kConicCentre,
             e.center,
             {},
             std::max(0.1, found.fit.center_sigma_px),
             e.arc_rad * 0.5 * (e.major_px + e.minor_px));
  }
}

void add_contours(const ChainFits& fits, FeatureList& list) {
  constexpr double kLeastArea_px2 = 60.0;  // smaller ones are specks
  for (const ClosedContour& contour : fits.contours) {
    if (contour.area_px2 < kLeastArea_px2) continue;
    const double sigma = std::max(0.1, 0.5 / std::sqrt(static_cast<double>(contour.points)));
    list.add(FeatureType::kCentroid,
             contour.centroid,
             {},
             sigma,
             0.5 * static_cast<double>(contour.points));
  }
}

}  // namespace

ImageFeatures find_image_features(const GreyImage& image,
                                  const FeatureSearchOptions& options,
                                  const RunContext& run) {
  check_input(image, options);
  ImageFeatures out;
  out.width = image.width;
  out.height = image.height;
  const EdgeMap map = find_edge_points(
      image, {options.smooth, options.low_contrast, options.high_contrast, options.max_edges}, run);
  EdgeChains chains = link_edges(map, options.min_chain_points, run);
  const StraightLens lens(options.camera, image.width, image.height);
  const EdgeChains straight = lens.active() ? straightened(chains, lens) : EdgeChains{};
  const EdgeChains& used = lens.active() ? straight : chains;
  ChainFitOptions fitting;
  fitting.split_px = options.split_px;
  fitting.min_length_px = options.min_segment_px;
  fitting.largest_axis_px = 2.0 * std::hypot(image.width, image.height);
  ChainFits fits = fit_chains(used.points, used.chains, fitting, run);

  keep_largest(fits.lines, options.max_segments, [](const FittedLine& l) { return l.length(); });
  keep_largest(fits.ellipses, options.max_ellipses, [](const FittedEllipse& e) {
    return e.fit.ellipse.arc_rad * e.fit.ellipse.major_px;
  });
  drop_concentric(fits.ellipses);
  const VertexGraph graph = find_vertices(fits.lines, options.vertex_reach_px, run);
  for (const FittedLine& line : fits.lines) {
    out.segments.push_back({lens.bend(line.start()), lens.bend(line.end()), line.rms_px});
  }
  FeatureList list(lens);
  for (const FoundVertex& vertex : graph.vertices) {
    list.add(FeatureType::kVertex, vertex.at, vertex.directions, vertex.sigma_px, vertex.strength);
  }
  add_ellipses(fits, lens, list, out);
  add_contours(fits, list);
  for (const Inflexion& inflexion : fits.inflexions) {
    constexpr double kStrength = 20.0;  // weaker than most corners
    const double back =
        std::remainder(inflexion.direction_rad + std::numbers::pi, 2.0 * std::numbers::pi);
    list.add(FeatureType::kInflexion,
             inflexion.at,
             {inflexion.direction_rad, back},
             inflexion.sigma_px,
             kStrength);
  }
  list.move_to(out, options.max_points, graph.links);
  out.edges = std::move(chains.points);
  return out;
}

}  // namespace landmarkdb
