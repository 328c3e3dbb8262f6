#include "engine/mono/fit_chains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>

#include "engine/mono/split_chain.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Piece {
  std::size_t begin = 0, end = 0;  // points [begin, end)
  FittedLine line{};
  bool moved = false;  // an end, since the line was fitted
};

// Where two neighbours cross is a better place to split than where the chain is farthest out.
void move_splits_to_crossings(std::span<const EdgePoint> points, std::vector<Piece>& pieces) {
  constexpr double kLeastSine = 0.2;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    Piece &a = pieces[i], &b = pieces[i + 1];
    if (a.line.points == 0 || b.line.points == 0) continue;
    const double sine =
        a.line.direction.x() * b.line.direction.y() - a.line.direction.y() * b.line.direction.x();
    if (std::abs(sine) < kLeastSine) continue;
    const Eigen::Vector2d w = b.line.center - a.line.center;
    const double along = (w.x() * b.line.direction.y() - w.y() * b.line.direction.x()) / sine;
    const Eigen::Vector2d crossing = a.line.at(along);
    std::size_t best = a.end;
    double nearest = 1e9;
    for (std::size_t k = a.begin + 2; k + 2 < b.end; ++k) {
      const double away = (points[k].uv.cast<double>() - crossing).squaredNorm();
      if (away < nearest) {
        nearest = away;
        best = k;
      }
    }
    if (best == a.end) continue;
    a.end = b.begin = best;
    a.moved = b.moved = true;
  }
}

std::span<const EdgePoint> points_of(std::span<const EdgePoint> points,
                                     std::size_t begin,
                                     std::size_t end) {
  return points.subspan(begin, end - begin);
}

std::vector<Piece> cut_into_pieces(std::span<const EdgePoint> points,
                                   std::span<const std::size_t> splits) {
  std::vector<Piece> pieces;
  pieces.reserve(splits.size());
  for (std::size_t i = 0; i + 1 < splits.size(); ++i) {
    const std::size_t end = i + 2 == splits.size() ? points.size() : splits[i + 1];
    pieces.push_back({splits[i], end, fit_line(points_of(points, splits[i], end))});
  }
  return pieces;
}

// The turn from one piece to the next, by their chords: (-pi, pi].
double turn_between(std::span<const EdgePoint> points, const Piece& a, const Piece& b) {
  const Eigen::Vector2f u = points[a.end - 1].uv - points[a.begin].uv;
  const Eigen::Vector2f v = points[b.end - 1].uv - points[b.begin].uv;
  return std::atan2(u.x() * v.y() - u.y() * v.x(), u.dot(v));
}

// Squared residuals over the noise, plus the parameters' price.
double cost_of(double rms_px, std::size_t n, double parameters, const EdgeNoise& noise) {
  const double count = static_cast<double>(n);
  return count * rms_px * rms_px / (noise.position_px * noise.position_px) +
         parameters * std::log(count);
}

double cost_of_lines(std::span<const Piece> pieces, const EdgeNoise& noise) {
  constexpr double kLineParameters = 4.0;  // its two, and where it ends
  double sum = 0.0;
  for (const Piece& piece : pieces) {
    // What a line left out as off it still has to be described: at the split's tolerance.
    const std::size_t n = piece.end - piece.begin;
    const std::size_t off = n - std::min(n, piece.line.points);
    sum +=
        cost_of(piece.line.rms_px, n, kLineParameters, noise) + cost_of(1.0, off + 1, 0.0, noise);
  }
  return sum;
}

// Every n-th point: neighbours say the same, and a hundred places determine an ellipse.
std::vector<EdgePoint> some_of(std::span<const EdgePoint> points) {
  constexpr std::size_t kEnough = 100;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kEnough);
  std::vector<EdgePoint> some;
  some.reserve(points.size() / step + 1);
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

std::optional<EllipseFit> try_ellipse(std::span<const EdgePoint> points,
                                      double cost_so_far,
                                      const ChainFitOptions& options) {
  constexpr double kLeastRatio = 0.1, kLargestRms_px = 1.0, kLeastArc = 60.0 * kDegree;
  constexpr double kParameters = 7.0;  // its five, and where it ends
  constexpr double kSmallest_px = 2.0;
  std::optional<EllipseFit> fit = fit_ellipse(some_of(points), options.noise);
  if (!fit) return std::nullopt;
  ImageEllipse& e = fit->ellipse;
  if (e.minor_px < kLeastRatio * e.major_px || e.minor_px < kSmallest_px ||
      e.major_px > options.largest_axis_px || e.rms_px > kLargestRms_px) {
    return std::nullopt;
  }
  if (cost_of(e.rms_px, points.size(), kParameters, options.noise) >= cost_so_far) {
    return std::nullopt;
  }
  e.arc_rad = arc_of(e, points);
  return e.arc_rad >= kLeastArc ? fit : std::nullopt;
}

// Runs of pieces that turn the same way, gently enough for an arc.
struct Run {
  std::size_t first = 0, last = 0;  // pieces, both in it
  double turn = 0.0;
};

std::vector<Run> curved_runs(std::span<const EdgePoint> points, const std::vector<Piece>& pieces) {
  constexpr double kSharpest = 80.0 * kDegree, kLeastTurn = 50.0 * kDegree;
  std::vector<Run> runs;
  Run run;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    const double turn = turn_between(points, pieces[i], pieces[i + 1]);
    const bool goes_on = std::abs(turn) < kSharpest && run.turn * turn >= 0.0;
    if (!goes_on) {
      if (std::abs(run.turn) >= kLeastTurn) runs.push_back(run);
      run = {i, i, 0.0};
      if (std::abs(turn) >= kSharpest) {
        run.first = run.last = i + 1;
        continue;
      }
    }
    run.last = i + 1;
    run.turn += turn;
  }
  if (std::abs(run.turn) >= kLeastTurn) runs.push_back(run);
  return runs;
}

// The area inside a closed chain and its centre of gravity.
ClosedContour area_of(std::span<const EdgePoint> points) {
  const Eigen::Vector2d origin = points[0].uv.cast<double>();
  double twice = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d a = points[i].uv.cast<double>() - origin;
    const Eigen::Vector2d b = points[(i + 1) % points.size()].uv.cast<double>() - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    twice += cross;
    moment += cross * (a + b);
  }
  ClosedContour contour;
  contour.area_px2 = std::abs(twice) / 2.0;
  contour.points = points.size();
  if (twice != 0.0) contour.centroid = origin + moment / (3.0 * twice);
  return contour;
}

// A closed chain begins at the point farthest from its middle: at a corner, if it has any.
std::vector<EdgePoint> started_at_corner(std::span<const EdgePoint> points) {
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (const EdgePoint& p : points) middle += p.uv / static_cast<float>(points.size());
  const auto corner = std::max_element(points.begin(), points.end(), [&](auto& a, auto& b) {
    return (a.uv - middle).squaredNorm() < (b.uv - middle).squaredNorm();
  });
  std::vector<EdgePoint> rotated(corner, points.end());
  rotated.insert(rotated.end(), points.begin(), corner);
  rotated.push_back(*corner);
  return rotated;
}

class ChainFitter {
 public:
  ChainFitter(const ChainFitOptions& options, ChainFits& fits) : options_(options), fits_(fits) {}

  void fit(std::span<const EdgePoint> chain, bool closed) {
    std::vector<EdgePoint> rotated;
    if (closed) {
      if (fit_whole(chain)) return;
      rotated = started_at_corner(chain);
      chain = rotated;
    }
    std::vector<Piece> pieces = cut_into_pieces(chain, splitter_.split(chain, options_.split_px));
    std::vector<bool> taken(pieces.size(), false);
    const std::vector<Run> runs = curved_runs(chain, pieces);
    for (const Run& run : runs) fit_arc(chain, pieces, run, taken);
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
      const bool adjacent = runs[i + 1].first <= runs[i].last + 1;
      if (adjacent && runs[i].turn * runs[i + 1].turn < 0.0)
        add_inflexion(chain, pieces, runs[i], runs[i + 1]);
    }
    move_splits_to_crossings(chain, pieces);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!taken[i]) add_line(chain, pieces[i]);
    }
  }

 private:
  bool fit_whole(std::span<const EdgePoint> chain) {
    const ClosedContour contour = area_of(chain);
    constexpr double kLeastArea_px2 = 30.0;
    if (contour.area_px2 < kLeastArea_px2) return false;
    constexpr std::size_t kFewestPieces = 4;
    const std::span<const std::size_t> splits = splitter_.split(chain, options_.split_px);
    if (splits.size() > kFewestPieces) {
      const double cost = cost_of_lines(cut_into_pieces(chain, splits), options_.noise);
      const std::optional<EllipseFit> fit = try_ellipse(chain, cost, options_);
      constexpr double kWhole = 300.0 * kDegree;
      if (fit && fit->ellipse.arc_rad > kWhole) {
        fits_.ellipses.push_back({*fit, true});
        return true;
      }
    }
    fits_.contours.push_back(contour);
    return false;
  }

  void fit_arc(std::span<const EdgePoint> chain,
               const std::vector<Piece>& pieces,
               const Run& run,
               std::vector<bool>& taken) {
    // The pieces at a run's ends may be straight lines that go on from the arc.
    constexpr std::array<std::array<std::size_t, 2>, 4> kTrims{{{0, 0}, {0, 1}, {1, 0}, {1, 1}}};
    for (const auto& [front, back] : kTrims) {
      if (run.last < run.first + front + back + 1) continue;
      const std::size_t first = run.first + front, last = run.last - back;
      const std::span<const Piece> part(&pieces[first], last - first + 1);
      const std::optional<EllipseFit> fit =
          try_ellipse(points_of(chain, part.front().begin, part.back().end),
                      cost_of_lines(part, options_.noise),
                      options_);
      if (!fit) continue;
      fits_.ellipses.push_back({*fit, false});
      std::fill_n(taken.begin() + static_cast<std::ptrdiff_t>(first), part.size(), true);
      return;
    }
  }

  void add_line(std::span<const EdgePoint> chain, const Piece& piece) {
    constexpr double kLargestRms_px = 0.75;  // half of what a piece may bend
    constexpr double kLeastShare = 0.5;      // of the points, on the line
    const std::span<const EdgePoint> points = points_of(chain, piece.begin, piece.end);
    const FittedLine line = piece.moved ? fit_line(points) : piece.line;
    if (line.length() < options_.min_length_px || line.rms_px > kLargestRms_px ||
        static_cast<double>(line.points) < kLeastShare * static_cast<double>(points.size())) {
      return;
    }
    fits_.lines.push_back(line);
  }

  // Where the tangent's angle, as a parabola of the place along the chain, has its extreme.
  void add_inflexion(std::span<const EdgePoint> chain,
                     const std::vector<Piece>& pieces,
                     const Run& before,
                     const Run& after);

  const ChainFitOptions& options_;
  ChainFits& fits_;
  ChainSplitter splitter_;
};

void ChainFitter::add_inflexion(std::span<const EdgePoint> chain,
                                const std::vector<Piece>& pieces,
                                const Run& before,
                                const Run& after) {
  const std::size_t begin = pieces[before.last].begin;
  const std::size_t end = pieces[after.first].end;
  constexpr std::size_t kFewest = 12;
  if (end < begin + kFewest) return;
  const std::span<const EdgePoint> part = points_of(chain, begin, end);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  const Eigen::Vector2f reference = part[part.size() / 2].normal;
  const double half = 0.5 * static_cast<double>(part.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    const double s = (static_cast<double>(i) - half) / half;
    const Eigen::Vector2f n = part[i].normal;
    const double angle =
        std::atan2(reference.x() * n.y() - reference.y() * n.x(), reference.dot(n));
    const Eigen::Vector3d row(1.0, s, s * s);
    H += row * row.transpose();
    g += angle * row;
  }
  const Eigen::Vector3d c = H.ldlt().solve(g);
  const double extreme = -c[1] / (2.0 * c[2]);
  constexpr double kLeastBend = 0.15;  // radians from the middle to an end
  if (!(std::abs(extreme) < 0.8) || std::abs(c[2]) < kLeastBend) return;
  const auto at = static_cast<std::size_t>(half + extreme * half);
  const EdgePoint& point = part[std::min(at, part.size() - 1)];
  // The angle is good to its noise over the root of the points about the extreme.
  const double sigma =
      half * options_.noise.direction_rad / (2.0 * std::abs(c[2]) * std::sqrt(half));
  fits_.inflexions.push_back({point.uv.cast<double>(),
                              std::atan2(point.normal.x(), -point.normal.y()),
                              std::max(0.5, sigma)});
}

}  // namespace

ChainFits fit_chains(std::span<const EdgePoint> points,
                     std::span<const EdgeChain> chains,
                     const ChainFitOptions& options,
                     const RunContext& run) {
  ChainFits fits;
  ChainFitter fitter(options, fits);
  for (const EdgeChain& chain : chains) {
    run.check("features");
    fitter.fit(points_of(points, chain.begin, chain.end), chain.closed);
  }
  return fits;
}

}  // namespace landmarkdb
