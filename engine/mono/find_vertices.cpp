#include "engine/mono/find_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace landmarkdb {
namespace {

constexpr double kLeastSine =
    0.26;  // 15 degrees: flatter crossings are badly placed along the line

// Which lines pass near a place: buckets of cells, each line entered where it passes.
class LineGrid {
 public:
  LineGrid(std::span<const FittedLine> lines, double cell_px)
      : cell_px_(cell_px), met_(lines.size(), 0) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
    for (const FittedLine& line : lines) {
      low = low.cwiseMin(line.start()).cwiseMin(line.end());
      high = high.cwiseMax(line.start()).cwiseMax(line.end());
    }
    if (lines.empty()) return;
    origin_ = low;
    columns_ = static_cast<std::int64_t>((high - low).x() / cell_px) + 1;
    rows_ = static_cast<std::int64_t>((high - low).y() / cell_px) + 1;
    fill(lines);
  }

  // Lines within a cell's size of the place, each once.
  void near(const Eigen::Vector2d& place, std::vector<std::uint32_t>& found) {
    found.clear();
    ++calls_;
    const auto [column, row] = cell_of(place);
    for (std::int64_t r = std::max<std::int64_t>(0, row - 1); r <= std::min(rows_ - 1, row + 1);
         ++r) {
      for (std::int64_t c = std::max<std::int64_t>(0, column - 1);
           c <= std::min(columns_ - 1, column + 1);
           ++c) {
        const auto cell = static_cast<std::size_t>(r * columns_ + c);
        for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
          if (std::exchange(met_[lines_[i]], calls_) != calls_) found.push_back(lines_[i]);
        }
      }
    }
  }

 private:
  void fill(std::span<const FittedLine> lines) {
    struct Entry {
      std::uint32_t cell, line;
    };
    std::vector<Entry> entries;
    starts_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (std::uint32_t i = 0; i < lines.size(); ++i) {
      const double step = cell_px_ / 2.0;
      for (double along = lines[i].from;; along += step) {
        const auto cell =
            static_cast<std::uint32_t>(index_of(lines[i].at(std::min(along, lines[i].to))));
        const bool known =
            !entries.empty() && entries.back().line == i && entries.back().cell == cell;
        if (!known) {
          entries.push_back({cell, i});
          ++starts_[cell + 1];
        }
        if (along >= lines[i].to) break;
      }
    }
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    lines_.resize(entries.size());
    std::vector<std::uint32_t> next = starts_;
    for (const Entry& entry : entries) lines_[next[entry.cell]++] = entry.line;
  }

  std::pair<std::int64_t, std::int64_t> cell_of(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d cell = (place - origin_) / cell_px_;
    return {static_cast<std::int64_t>(std::floor(cell.x())),
            static_cast<std::int64_t>(std::floor(cell.y()))};
  }
  std::size_t index_of(const Eigen::Vector2d& place) const {
    const auto [column, row] = cell_of(place);
    return static_cast<std::size_t>(std::clamp<std::int64_t>(row, 0, rows_ - 1) * columns_ +
                                    std::clamp<std::int64_t>(column, 0, columns_ - 1));
  }

  double cell_px_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> starts_;  // of each cell in lines_, and their end
  std::vector<std::uint32_t> lines_;   // by cell
  std::uint32_t calls_ = 0;
  std::vector<std::uint32_t> met_;  // by line: the last call that met it
};

struct Crossing {
  std::uint32_t a = 0, b = 0;  // lines
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double quality = 0.0;
};

// How far along line a it crosses line b; nullopt where they are too parallel.
std::optional<double> crossing_along(const FittedLine& a, const FittedLine& b, double& sine) {
  sine = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(sine) < kLeastSine) return std::nullopt;
  const Eigen::Vector2d w = b.center - a.center;
  return (w.x() * b.direction.y() - w.y() * b.direction.x()) / sine;
}

std::vector<Crossing> find_crossings(std::span<const FittedLine> lines,
                                     double reach_px,
                                     const RunContext& run) {
  LineGrid grid(lines, 2.0 * reach_px);
  std::vector<Crossing> crossings;
  std::vector<std::uint32_t> near;
  for (std::uint32_t a = 0; a < lines.size(); ++a) {
    if (a % 64 == 0) run.check("features");
    for (const double end : {lines[a].from, lines[a].to}) {
      grid.near(lines[a].at(end), near);
      for (const std::uint32_t b : near) {
        double sine = 0.0;
        if (b == a) continue;
        const std::optional<double> along = crossing_along(lines[a], lines[b], sine);
        if (!along || std::abs(*along - end) > reach_px) continue;
        const Eigen::Vector2d at = lines[a].at(*along);
        const double along_b = (at - lines[b].center).dot(lines[b].direction);
        if (along_b < lines[b].from - reach_px || along_b > lines[b].to + reach_px) continue;
        const double shorter = std::min(lines[a].length(), lines[b].length());
        crossings.push_back({a, b, at, shorter * std::abs(sine)});
      }
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& p, const Crossing& q) {
    return std::tuple(-p.quality, p.a, p.b) < std::tuple(-q.quality, q.a, q.b);
  });
  return crossings;
}

struct Cluster {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::vector<std::uint32_t> lines{};
};

std::vector<Cluster> cluster(const std::vector<Crossing>& crossings) {
  constexpr double kSame_px = 3.0;
  std::vector<Cluster> clusters;
  const auto add = [](Cluster& to, std::uint32_t line) {
    if (std::find(to.lines.begin(), to.lines.end(), line) == to.lines.end()) {
      to.lines.push_back(line);
    }
  };
  for (const Crossing& crossing : crossings) {
    Cluster* home = nullptr;
    double nearest = kSame_px;
    for (Cluster& c : clusters) {
      const double away = (c.at - crossing.at).norm();
      if (away < nearest) {
        nearest = away;
        home = &c;
      }
    }
    if (home == nullptr) home = &clusters.emplace_back(Cluster{crossing.at});
    add(*home, crossing.a);
    add(*home, crossing.b);
  }
  return clusters;
}

struct Placed {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double sigma_px = 0.0;
};

// Where lines cross best, each by what it is good for there.
std::optional<Placed> place(std::span<const FittedLine> lines,
                            const std::vector<std::uint32_t>& members,
                            const Eigen::Vector2d& start) {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (const std::uint32_t i : members) {
    const FittedLine& line = lines[i];
    const Eigen::Vector2d normal(line.direction.y(), -line.direction.x());
    const double sigma = line.sigma_at((start - line.center).dot(line.direction));
    const double weight = 1.0 / (sigma * sigma);
    H += weight * normal * normal.transpose();
    g += weight * normal.dot(line.center - start) * normal;
  }
  const Eigen::Vector2d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(H).eigenvalues();
  if (!(values[0] > 1e-9)) return std::nullopt;
  constexpr double kLeastSigma_px = 0.1;  // corners are rounded by what smooths the image
  return Placed{start + H.inverse() * g, std::max(kLeastSigma_px, 1.0 / std::sqrt(values[0]))};
}

// The directions in which the lines go on from the vertex, nearly equal ones once.
std::vector<double> directions_of(std::span<const FittedLine> lines,
                                  const std::vector<std::uint32_t>& members,
                                  const Eigen::Vector2d& at) {
  constexpr double kLeastReach_px = 6.0;  // a line's own end lies up to 5 px from the vertex
  constexpr double kSame_rad = 0.2;
  std::vector<double> directions;
  const auto add = [&](double angle) {
    const bool known = std::any_of(directions.begin(), directions.end(), [&](double other) {
      return std::abs(std::remainder(other - angle, 2.0 * std::numbers::pi)) < kSame_rad;
    });
    if (!known) directions.push_back(angle);
  };
  for (const std::uint32_t i : members) {
    const FittedLine& line = lines[i];
    const double along = (at - line.center).dot(line.direction);
    const double angle = std::atan2(line.direction.y(), line.direction.x());
    if (line.to - along > kLeastReach_px) add(angle);
    if (along - line.from > kLeastReach_px) {
      add(std::remainder(angle + std::numbers::pi, 2.0 * std::numbers::pi));
    }
  }
  std::sort(directions.begin(), directions.end());
  return directions;
}

// Two of the lines must cross at an angle: collinear ones alone fix no place.
std::optional<FoundVertex> vertex_of(std::span<const FittedLine> lines, Cluster& found) {
  constexpr double kFarthest_px = 1.5;
  std::optional<Placed> placed = place(lines, found.lines, found.at);
  while (placed && found.lines.size() > 2) {
    const auto off = [&](std::uint32_t i) {
      const Eigen::Vector2d w = placed->at - lines[i].center;
      return std::abs(w.x() * lines[i].direction.y() - w.y() * lines[i].direction.x());
    };
    const auto worst = std::max_element(
        found.lines.begin(), found.lines.end(), [&](auto a, auto b) { return off(a) < off(b); });
    if (off(*worst) <= kFarthest_px) break;
    found.lines.erase(worst);
    placed = place(lines, found.lines, found.at);
  }
  if (!placed) return std::nullopt;
  FoundVertex vertex{placed->at, directions_of(lines, found.lines, placed->at), placed->sigma_px};
  if (vertex.directions.size() < 2) return std::nullopt;
  for (const std::uint32_t i : found.lines) vertex.strength += lines[i].length();
  return vertex;
}

}  // namespace

VertexGraph find_vertices(std::span<const FittedLine> lines,
                          double reach_px,
                          const RunContext& run) {
  std::vector<Cluster> clusters = cluster(find_crossings(lines, reach_px, run));
  VertexGraph graph;
  std::vector<std::vector<std::pair<double, std::uint32_t>>> on_line(lines.size());
  for (Cluster& found : clusters) {
    std::optional<FoundVertex> vertex = vertex_of(lines, found);
    if (!vertex) continue;
    const auto index = static_cast<std::uint32_t>(graph.vertices.size());
    for (const std::uint32_t i : found.lines) {
      on_line[i].push_back({(vertex->at - lines[i].center).dot(lines[i].direction), index});
    }
    graph.vertices.push_back(std::move(*vertex));
  }
  for (auto& line : on_line) {
    std::sort(line.begin(), line.end());
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      graph.links.push_back({std::min(a, b), std::max(a, b)});
    };
    for (std::size_t i = 0; i + 1 < line.size(); ++i) join(line[i].second, line[i + 1].second);
    if (line.size() > 2) join(line.front().second, line.back().second);
  }
  std::sort(graph.links.begin(), graph.links.end());
  graph.links.erase(std::unique(graph.links.begin(), graph.links.end()), graph.links.end());
  return graph;
}

}  // namespace landmarkdb
