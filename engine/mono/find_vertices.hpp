#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/fit_chains.hpp"

namespace landmarkdb {

// Where lines meet.
struct FoundVertex {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::vector<double> directions{};  // of the lines, away from here; radians
  double sigma_px = 0.0;
  double strength = 0.0;  // what the lines that meet measure, px: longer ones are surer
};

struct VertexGraph {
  std::vector<FoundVertex> vertices{};
  std::vector<std::array<std::uint32_t, 2>> links{};  // joined by a line; smaller index first
};

// The places within `reach_px` of a line's end where it crosses another line: corners, T and X
// junctions. What lies within 3 px is one vertex, placed where all its lines cross best.
VertexGraph find_vertices(std::span<const FittedLine> lines,
                          double reach_px,
                          const RunContext& run);

}  // namespace landmarkdb
