#include "engine/mono/model_symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "engine/geometry/pose.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

constexpr double kTolerance = 1e-3;       // of the diameter; see the header
constexpr double kSameDirection = 0.999;  // cosine; 2.6 degrees, normals are rarely measured better

using Permutation = std::vector<std::uint32_t>;

class SymmetryFinder {
 public:
  explicit SymmetryFinder(const MonoModel& model)
      : model_(model), tolerance_m_(kTolerance * model.diameter_m), flat_(is_flat(model)) {
    for (const ModelFeature& p : model.points) centre_ += p.xyz;
    centre_ /= static_cast<double>(model.points.size());
    for (const auto& edge : model.edges) edges_.insert(edge);
    for (const auto& face : model.faces) faces_.insert(sorted(face));
  }

  std::vector<Eigen::Matrix4d> find(const RunContext& context) const {
    std::vector<Eigen::Matrix4d> found{Eigen::Matrix4d::Identity()};
    const auto base = choose_base();
    if (!base) return found;
    const auto [p, q] = *base;
    const Eigen::Matrix3d from = frame(at(p), at(q));
    for (std::uint32_t i = 0; i < model_.points.size(); ++i) {
      context.check("symmetries");
      if (!alike(p, i)) continue;
      for (std::uint32_t j = 0; j < model_.points.size(); ++j) {
        if (j == i || !alike(q, j)) continue;
        if (std::abs((at(p) - at(q)).norm() - (at(i) - at(j)).norm()) > tolerance_m_) continue;
        const Eigen::Matrix3d R = frame(at(i), at(j)) * from.transpose();
        const std::optional<Permutation> map = permutation(R);
        if (!map || !keeps_all(R, *map)) continue;
        keep(exact(*map), found);
      }
    }
    make_group(found);
    std::stable_sort(found.begin() + 1, found.end(), [](const auto& a, const auto& b) {
      return a.template topLeftCorner<3, 3>().trace() >
             b.template topLeftCorner<3, 3>().trace() + 1e-9;
    });
    return found;
  }

 private:
  static std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> face) {
    std::sort(face.begin(), face.end());
    face.erase(std::unique(face.begin(), face.end()), face.end());  // a bridge names corners twice
    return face;
  }

  Eigen::Vector3d at(std::uint32_t i) const { return model_.points[i].xyz - centre_; }

  bool alike(std::uint32_t i, std::uint32_t j) const {
    return model_.points[i].type == model_.points[j].type &&
           std::abs(at(i).norm() - at(j).norm()) <= tolerance_m_;
  }

  static Eigen::Matrix3d frame(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    Eigen::Matrix3d axes;
    axes.col(0) = p.normalized();
    axes.col(2) = p.cross(q).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
  }

  std::size_t alike_count(std::uint32_t i) const {
    std::size_t count = 0;
    for (std::uint32_t j = 0; j < model_.points.size(); ++j) count += alike(i, j) ? 1 : 0;
    return count;
  }

  // Two points, with few of their kind, that fix a rotation about the centre.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> choose_base() const {
    std::optional<std::pair<std::uint32_t, std::uint32_t>> best;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> counts(model_.points.size());
    for (std::uint32_t i = 0; i < counts.size(); ++i) counts[i] = alike_count(i);
    for (std::uint32_t i = 0; i < counts.size(); ++i) {
      for (std::uint32_t j = 0; j < counts.size(); ++j) {
        const double area = at(i).cross(at(j)).norm();
        // A tenth of the diameter off a common line: the frame then turns by little more than the
        // tolerance.
        if (area < 0.1 * model_.diameter_m * at(i).norm() ||
            at(i).norm() < 0.1 * model_.diameter_m) {
          continue;
        }
        if (counts[i] * counts[j] < least) {
          least = counts[i] * counts[j];
          best = {i, j};
        }
      }
    }
    return best;
  }

  bool same_normal(const Eigen::Matrix3d& R,
                   const std::optional<Eigen::Vector3d>& a,
                   const std::optional<Eigen::Vector3d>& b) const {
    if (a.has_value() != b.has_value()) return false;
    return !a || (R * *a).dot(*b) > kSameDirection;
  }

  std::optional<Permutation> permutation(const Eigen::Matrix3d& R) const {
    Permutation map(model_.points.size());
    std::vector<bool> taken(model_.points.size(), false);
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      const Eigen::Vector3d moved = R * at(i);
      double nearest = tolerance_m_;
      std::optional<std::uint32_t> hit;
      for (std::uint32_t j = 0; j < map.size(); ++j) {
        const double distance = (moved - at(j)).norm();
        if (distance <= nearest && !taken[j] && model_.points[j].type == model_.points[i].type) {
          nearest = distance;
          hit = j;
        }
      }
      if (!hit || !same_normal(R, model_.points[i].normal, model_.points[*hit].normal)) {
        return std::nullopt;
      }
      map[i] = *hit;
      taken[*hit] = true;
    }
    return map;
  }

  bool keeps_all(const Eigen::Matrix3d& R, const Permutation& map) const {
    for (const auto& [a, b] : model_.edges) {
      if (!edges_.contains({std::min(map[a], map[b]), std::max(map[a], map[b])})) return false;
    }
    for (const auto& face : model_.faces) {
      std::vector<std::uint32_t> moved;
      for (const std::uint32_t corner : face) moved.push_back(map[corner]);
      if (!faces_.contains(sorted(std::move(moved)))) return false;
    }
    return std::all_of(model_.circles.begin(), model_.circles.end(), [&](const ModelCircle& c) {
      return std::any_of(model_.circles.begin(), model_.circles.end(), [&](const ModelCircle& d) {
        const double along = (R * c.normal).dot(d.normal);
        return (R * (c.center - centre_) - (d.center - centre_)).norm() <= tolerance_m_ &&
               std::abs(c.radius_m - d.radius_m) <= tolerance_m_ &&
               (flat_ ? std::abs(along) : along) > kSameDirection;
      });
    });
  }

  // The rigid motion that fits the permutation best, over all points.
  Eigen::Matrix4d exact(const Permutation& map) const {
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> target;
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      source.push_back(model_.points[i].xyz);
      target.push_back(model_.points[map[i]].xyz);
    }
    const auto fit = estimate_similarity(target, source, false);
    return fit ? fit->matrix() : Eigen::Matrix4d::Identity();
  }

  static void keep(const Eigen::Matrix4d& T, std::vector<Eigen::Matrix4d>& found) {
    constexpr double kSame = 1e-2;  // elements of two rotations of one group differ by far more
    for (const Eigen::Matrix4d& other : found) {
      if ((T - other).topLeftCorner<3, 3>().cwiseAbs().maxCoeff() < kSame) return;
    }
    found.push_back(T);
  }

  static bool holds(const std::vector<Eigen::Matrix4d>& found, const Eigen::Matrix4d& T) {
    return std::any_of(found.begin(), found.end(), [&](const Eigen::Matrix4d& other) {
      constexpr double kSame = 2e-2;  // two of them, each as exact as the model
      return (T - other).topLeftCorner<3, 3>().cwiseAbs().maxCoeff() < kSame;
    });
  }

  // Where a model is symmetric only just within the tolerance, a product of two symmetries may lie
  // just outside: the least exact go until all products are there.
  void make_group(std::vector<Eigen::Matrix4d>& found) const {
    const auto closed = [&] {
      for (const Eigen::Matrix4d& a : found) {
        for (const Eigen::Matrix4d& b : found) {
          if (!holds(found, a * b)) return false;
        }
      }
      return true;
    };
    while (found.size() > 1 && !closed()) {
      found.erase(std::max_element(
          found.begin() + 1, found.end(), [&](const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
            return symmetry_error_m(model_, a) < symmetry_error_m(model_, b);
          }));
    }
  }

  const MonoModel& model_;
  double tolerance_m_;
  bool flat_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  std::set<std::array<std::uint32_t, 2>> edges_{};
  std::set<std::vector<std::uint32_t>> faces_{};
};

// The half turn that swaps the ends of a body of revolution, if its circles allow it.
std::optional<Eigen::Matrix4d> end_swap(const MonoModel& model) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ModelCircle& c : model.circles) middle += c.center;
  middle /= static_cast<double>(model.circles.size());
  const Eigen::Vector3d axis = model.circles.front().normal;
  const Eigen::Vector3d across = axis.unitOrthogonal();
  const Eigen::Matrix3d R = 2.0 * across * across.transpose() - Eigen::Matrix3d::Identity();
  const double tolerance_m = kTolerance * model.diameter_m;
  for (const ModelCircle& c : model.circles) {
    const bool lands =
        std::any_of(model.circles.begin(), model.circles.end(), [&](const ModelCircle& d) {
          return (R * (c.center - middle) - (d.center - middle)).norm() <= tolerance_m &&
                 std::abs(c.radius_m - d.radius_m) <= tolerance_m &&
                 (R * c.normal).dot(d.normal) > kSameDirection;
        });
    if (!lands) return std::nullopt;
  }
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = R;
  T.topRightCorner<3, 1>() = middle - R * middle;
  return T;
}

}  // namespace

std::vector<Eigen::Matrix4d> derive_symmetries(const MonoModel& model, const RunContext& context) {
  std::vector<Eigen::Matrix4d> identity{Eigen::Matrix4d::Identity()};
  if (is_revolution(model)) {
    if (const auto swap = end_swap(model)) identity.push_back(*swap);
    return identity;
  }
  if (model.points.size() < 3) return identity;
  return SymmetryFinder(model).find(context);
}

double symmetry_error_m(const MonoModel& model, const Eigen::Matrix4d& T) {
  double worst = 0.0;
  for (const ModelFeature& p : model.points) {
    const Eigen::Vector3d moved = T.topLeftCorner<3, 3>() * p.xyz + T.topRightCorner<3, 1>();
    double nearest = std::numeric_limits<double>::infinity();
    for (const ModelFeature& q : model.points) {
      if (p.type == q.type) nearest = std::min(nearest, (moved - q.xyz).norm());
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

bool is_revolution(const MonoModel& model) {
  if (model.circles.empty() || !model.edges.empty() || !model.faces.empty()) return false;
  const ModelCircle& first = model.circles.front();
  const double tolerance_m = kTolerance * model.diameter_m;
  const auto off_axis = [&](const Eigen::Vector3d& xyz) {
    return (xyz - first.center).cross(first.normal).norm() > tolerance_m;
  };
  return std::none_of(model.circles.begin(),
                      model.circles.end(),
                      [&](const ModelCircle& c) {
                        return off_axis(c.center) ||
                               std::abs(c.normal.dot(first.normal)) < kSameDirection;
                      }) &&
         std::none_of(model.points.begin(), model.points.end(), [&](const ModelFeature& p) {
           return p.type != FeatureType::kConicCentre || off_axis(p.xyz);
         });
}

std::string symmetry_class(const MonoModel& model) {
  if (is_revolution(model)) return "revolution";
  const std::size_t count = model.symmetries.size();
  if (count <= 1) return "none";
  // How many turns each axis has; an axis and its opposite are one.
  std::vector<std::pair<Eigen::Vector3d, std::size_t>> axes;
  for (const Eigen::Matrix4d& T : model.symmetries) {
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(T.topLeftCorner<3, 3>()));
    constexpr double kNoTurn_rad = 1e-2;
    if (std::abs(turn.angle()) < kNoTurn_rad) continue;
    const auto same = std::find_if(axes.begin(), axes.end(), [&](const auto& axis) {
      return std::abs(axis.first.dot(turn.axis())) > kSameDirection;
    });
    if (same == axes.end()) {
      axes.emplace_back(turn.axis(), 1);
    } else {
      ++same->second;
    }
  }
  if (axes.empty()) return "none";
  std::size_t order = 0;
  for (const auto& axis : axes) order = std::max(order, axis.second + 1);
  if (axes.size() == 1) return "c" + std::to_string(order);
  if (count == 2 * order) return "d" + std::to_string(order);
  if (count == 12 && order == 3) return "tetrahedron";
  if (count == 24 && order == 4) return "cube";
  if (count == 60 && order == 5) return "icosahedron";
  return "other";
}

}  // namespace landmarkdb
