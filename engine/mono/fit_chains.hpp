#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/edge_chains.hpp"
#include "engine/mono/fit_ellipse.hpp"

namespace landmarkdb {

// A line fitted to edge points by total least squares, ends at the outermost of its points.
struct FittedLine {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();      // mean of the points
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit; brighter on its left
  double from = 0.0, to = 0.0;                           // along it, from the centre; px
  double rms_px = 0.0;                                   // across it
  double spread_px = 0.0;                                // rms along it
  std::size_t points = 0;

  Eigen::Vector2d at(double along) const { return center + along * direction; }
  Eigen::Vector2d start() const { return at(from); }
  Eigen::Vector2d end() const { return at(to); }
  double length() const { return to - from; }
  // Standard deviation across the line at a place along it.
  double sigma_at(double along) const;
};

struct FittedEllipse {
  EllipseFit fit;
  bool whole = false;  // from a closed chain
};

// An area enclosed by a closed chain.
struct ClosedContour {
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  double area_px2 = 0.0;
  std::size_t points = 0;
};

// A place where a smooth arc changes the side it bends to.
struct Inflexion {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double direction_rad = 0.0;  // of the tangent
  double sigma_px = 0.0;
};

struct ChainFits {
  std::vector<FittedLine> lines{};
  std::vector<FittedEllipse> ellipses{};
  std::vector<ClosedContour> contours{};  // those that are no ellipse
  std::vector<Inflexion> inflexions{};
};

struct ChainFitOptions {
  EdgeNoise noise{};
  double split_px = 1.5;         // Ramer-Douglas-Peucker
  double min_length_px = 8.0;    // of a line
  double largest_axis_px = 1e4;  // of an ellipse
};

// Splits every chain at its corners and fits lines, and ellipses where they describe consecutive
// pieces at a lower cost (squared residuals over the noise, plus parameters times log n).
// `points` are those of the chains, moved where the lens is straight.
ChainFits fit_chains(std::span<const EdgePoint> points,
                     std::span<const EdgeChain> chains,
                     const ChainFitOptions& options,
                     const RunContext& run);

// Total least squares; points whose gradient is over 15 degrees from the normal, and then those
// over 2.5 sigma away, are left out. `points` 0 where nothing remains.
FittedLine fit_line(std::span<const EdgePoint> points);

}  // namespace landmarkdb
