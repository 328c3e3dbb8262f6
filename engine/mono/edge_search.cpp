#include "engine/mono/edge_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace landmarkdb {
namespace {

// Grey value between pixels; outside the image that of its border.
double grey_at(const GreyImage& image, double x, double y) {
  x = std::clamp(x, 0.0, static_cast<double>(image.width - 1));
  y = std::clamp(y, 0.0, static_cast<double>(image.height - 1));
  const std::size_t x0 = std::min<std::size_t>(static_cast<std::size_t>(x), image.width - 1);
  const std::size_t y0 = std::min<std::size_t>(static_cast<std::size_t>(y), image.height - 1);
  const std::size_t x1 = std::min<std::size_t>(x0 + 1, image.width - 1);
  const std::size_t y1 = std::min<std::size_t>(y0 + 1, image.height - 1);
  const double fx = x - static_cast<double>(x0);
  const double fy = y - static_cast<double>(y0);
  const double top = image.at(x0, y0) * (1.0 - fx) + image.at(x1, y0) * fx;
  const double bottom = image.at(x0, y1) * (1.0 - fx) + image.at(x1, y1) * fx;
  return top * (1.0 - fy) + bottom * fy;
}

// Grey values on three lines across the edge, a pixel apart, at whole offsets from -half to half.
struct Profile {
  int half = 0;
  std::array<std::vector<double>, 3> lines{};

  void take(const GreyImage& image, const TrackSample& sample) {
    const Eigen::Vector2d along(-sample.normal.y(), sample.normal.x());
    for (std::size_t line = 0; line < 3; ++line) {
      lines[line].resize(static_cast<std::size_t>(2 * half + 1));
      for (int k = -half; k <= half; ++k) {
        const Eigen::Vector2d at =
            sample.uv + k * sample.normal + (static_cast<double>(line) - 1.0) * along;
        lines[line][static_cast<std::size_t>(k + half)] = grey_at(image, at.x(), at.y());
      }
    }
  }
  double mean(std::size_t i) const { return (lines[0][i] + lines[1][i] + lines[2][i]) / 3.0; }
  // Derivative across the edge (central difference), and along it, at index i.
  double across(std::size_t i) const { return 0.5 * (mean(i + 1) - mean(i - 1)); }
  double along(std::size_t i) const {
    double sum = 0.0;
    for (std::size_t k = i - 1; k <= i + 1; ++k) sum += lines[2][k] - lines[0][k];
    return sum / 6.0;  // over three places, two pixels apart
  }
};

// Where the parabola through three values has its top, in steps from the middle one.
double parabola_top(double before, double middle, double after) {
  const double bend = before - 2.0 * middle + after;
  return bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

// How unlike two looks are, brightness apart: 0 the same, 1 as unlike as two that have nothing in
// common, up to 2.
double unlikeness(const EdgeLook& a, const EdgeLook& b) {
  double mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += static_cast<double>(a[i]) / static_cast<double>(a.size());
    mean_b += static_cast<double>(b[i]) / static_cast<double>(b.size());
  }
  double off = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double da = static_cast<double>(a[i]) - mean_a;
    const double db = static_cast<double>(b[i]) - mean_b;
    off += (da - db) * (da - db);
    spread += da * da + db * db;
  }
  return spread > 0.0 ? off / spread : 0.0;
}

constexpr double kUnlike = 0.8;      // more is another edge
constexpr double kUnlike_px = 10.0;  // of unlikeness 1, in distance

}  // namespace

void EdgeMemory::clear() {
  for (std::vector<Entry>& curve : curves_) curve.clear();
}

void EdgeMemory::remember(const TrackSample& sample, const EdgeLook& look) {
  curves_[sample.curve].push_back({sample.share, look});
}

const EdgeLook* EdgeMemory::recall(const TrackSample& sample, double reach) const {
  const EdgeLook* nearest = nullptr;
  for (const Entry& entry : curves_[sample.curve]) {
    const double off = std::abs(entry.share - sample.share);
    if (off > reach) continue;
    reach = off;
    nearest = &entry.look;
  }
  return nearest;
}

EdgeLook look_at_edge(const GreyImage& image, const TrackSample& sample, double offset_px) {
  const Eigen::Vector2d along(-sample.normal.y(), sample.normal.x());
  EdgeLook look{};
  for (int k = -kLookHalf_px; k <= kLookHalf_px; ++k) {
    double sum = 0.0;
    for (int line = -1; line <= 1; ++line) {
      const Eigen::Vector2d at = sample.uv + (offset_px + k) * sample.normal + line * along;
      sum += grey_at(image, at.x(), at.y());
    }
    look[static_cast<std::size_t>(k + kLookHalf_px)] = static_cast<float>(sum / 3.0);
  }
  return look;
}

EdgeCandidates search_image_edges(const GreyImage& image,
                                  std::span<const TrackSample> samples,
                                  const EdgeMemory& memory,
                                  const EdgeSearchOptions& options) {
  EdgeCandidates result;
  Profile profile;
  const int reach = static_cast<int>(std::ceil(options.reach_px));
  profile.half = reach + 2;  // one for the derivative, one for the neighbour of an extremum
  std::vector<double> slope(static_cast<std::size_t>(2 * profile.half + 1));
  for (const TrackSample& sample : samples) {
    profile.take(image, sample);
    constexpr double kSamePlace = 0.1;  // of a curve
    const EdgeLook* before = memory.recall(sample, kSamePlace);
    for (std::size_t i = 1; i + 1 < slope.size(); ++i) slope[i] = profile.across(i);
    for (std::size_t i = 2; i + 2 < slope.size(); ++i) {
      const double here = std::abs(slope[i]);
      if (here < options.min_contrast || here < std::abs(slope[i - 1]) ||
          here <= std::abs(slope[i + 1])) {
        continue;
      }
      const double cosine = here / std::hypot(here, profile.along(i));
      if (cosine < options.min_cosine) continue;
      const double top = parabola_top(std::abs(slope[i - 1]), here, std::abs(slope[i + 1]));
      const double offset = static_cast<double>(i) - profile.half + top;
      const double unlike =
          before == nullptr ? 0.0 : unlikeness(*before, look_at_edge(image, sample, offset));
      if (unlike > kUnlike) continue;
      result.list.push_back({static_cast<float>(offset),
                             static_cast<float>(slope[i]),
                             static_cast<float>(cosine),
                             static_cast<float>(kUnlike_px * unlike)});
    }
    result.starts.push_back(static_cast<std::uint32_t>(result.list.size()));
  }
  return result;
}

EdgeCandidates search_edge_points(std::span<const EdgePoint> edges,
                                  std::span<const TrackSample> samples,
                                  const EdgeSearchOptions& options) {
  // By rows of the image, so that a sample looks at the few that its search line crosses.
  std::vector<std::uint32_t> order(edges.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return edges[a].uv.y() != edges[b].uv.y() ? edges[a].uv.y() < edges[b].uv.y() : a < b;
  });
  const auto row_begins = [&](double y) {
    return std::lower_bound(order.begin(), order.end(), y, [&](std::uint32_t i, double value) {
      return static_cast<double>(edges[i].uv.y()) < value;
    });
  };
  constexpr double kBeside_px = 0.75;  // edge points stand a pixel or so apart
  EdgeCandidates result;
  for (const TrackSample& sample : samples) {
    const std::size_t first = result.list.size();
    const double up = std::abs(sample.normal.y()) * options.reach_px + kBeside_px;
    const auto end = row_begins(sample.uv.y() + up);
    for (auto it = row_begins(sample.uv.y() - up); it != end; ++it) {
      const Eigen::Vector2d off = edges[*it].uv.cast<double>() - sample.uv;
      const double offset = off.dot(sample.normal);
      const double beside = off.x() * sample.normal.y() - off.y() * sample.normal.x();
      if (std::abs(offset) > options.reach_px || std::abs(beside) > kBeside_px) continue;
      const double turn = edges[*it].normal.cast<double>().dot(sample.normal);
      if (std::abs(turn) < options.min_cosine) continue;
      result.list.push_back({static_cast<float>(offset),
                             turn < 0.0 ? -1.0F : 1.0F,
                             static_cast<float>(std::abs(turn))});
    }
    std::sort(
        result.list.begin() + static_cast<std::ptrdiff_t>(first),
        result.list.end(),
        [](const EdgeCandidate& a, const EdgeCandidate& b) { return a.offset_px < b.offset_px; });
    result.starts.push_back(static_cast<std::uint32_t>(result.list.size()));
  }
  return result;
}

}  // namespace landmarkdb
