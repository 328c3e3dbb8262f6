#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "engine/geometry/pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {
namespace {

constexpr double kOnPoint = 1e-3;           // of the diameter
constexpr std::size_t kBases = 6;           // triples that motions are taken from
constexpr std::size_t kMostMotions = 6000;  // tried a base: models of hundreds of equal points
constexpr std::size_t kMostPoints = 256;    // larger models have none looked for

struct Motion {
  std::size_t carried = 0;
  Eigen::Isometry3d T;
};

// Orthonormal axes of a triple, or nullopt where it is nearly collinear.
bool axes_of(const Eigen::Vector3d& a,
             const Eigen::Vector3d& b,
             const Eigen::Vector3d& c,
             Eigen::Matrix3d& F) {
  const Eigen::Vector3d u = b - a, n = u.cross(c - a);
  if (n.norm() < 0.05 * u.norm() * (c - a).norm() || !(u.norm() > 0.0)) return false;
  F.col(0) = u.normalized();
  F.col(2) = n.normalized();
  F.col(1) = F.col(2).cross(F.col(0));
  return true;
}

std::size_t count_carried(const MonoModel& model, const Eigen::Isometry3d& T, double near) {
  std::size_t carried = 0;
  for (const ModelFeature& p : model.points) {
    const Eigen::Vector3d at = T * p.xyz;
    for (const ModelFeature& q : model.points) {
      if (q.type == p.type && (q.xyz - at).cwiseAbs().maxCoeff() < near) {
        ++carried;
        break;
      }
    }
  }
  return carried;
}

bool is_symmetry(const MonoModel& model, const Eigen::Isometry3d& T, double near) {
  if (T.matrix().isApprox(Eigen::Matrix4d::Identity(), 1e-6)) return true;
  for (const Eigen::Matrix4d& S : model.symmetries) {
    if ((S.topLeftCorner<3, 3>() - T.linear()).cwiseAbs().maxCoeff() < 1e-2 &&
        (S.topRightCorner<3, 1>() - T.translation()).norm() < 10.0 * near) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Eigen::Isometry3d> find_lookalikes(const MonoModel& model,
                                               double share,
                                               std::size_t most) {
  const std::size_t n = model.points.size();
  std::vector<Eigen::Isometry3d> result;
  if (n < 5 || n > kMostPoints) return result;
  const double near = kOnPoint * model.diameter_m;
  const auto xyz = [&](std::size_t i) -> const Eigen::Vector3d& { return model.points[i].xyz; };
  const auto type = [&](std::size_t i) { return model.points[i].type; };
  const std::size_t need =
      std::max<std::size_t>(4, static_cast<std::size_t>(std::ceil(share * static_cast<double>(n))));
  std::map<std::array<long, 6>, Motion> found;
  for (std::size_t base = 0; base < kBases; ++base) {
    // A base of points that lie near each other: one that a motion carries onto the model as a
    // whole.
    const std::size_t i = base * n / kBases;
    std::vector<std::size_t> by_distance;
    for (std::size_t k = 0; k < n; ++k) {
      if (k != i) by_distance.push_back(k);
    }
    std::stable_sort(by_distance.begin(), by_distance.end(), [&](std::size_t a, std::size_t b) {
      return (xyz(a) - xyz(i)).squaredNorm() < (xyz(b) - xyz(i)).squaredNorm();
    });
    const std::size_t j = by_distance[0];
    Eigen::Matrix3d F;
    std::size_t at = 1;
    while (at < by_distance.size() && !axes_of(xyz(i), xyz(j), xyz(by_distance[at]), F)) ++at;
    if (at == by_distance.size()) continue;
    const std::size_t k = by_distance[at];
    const double ij = (xyz(i) - xyz(j)).norm(), ik = (xyz(i) - xyz(k)).norm();
    const double jk = (xyz(j) - xyz(k)).norm();
    std::size_t tried = 0;
    for (std::size_t a = 0; a < n && tried < kMostMotions; ++a) {
      if (type(a) != type(i)) continue;
      for (std::size_t b = 0; b < n && tried < kMostMotions; ++b) {
        if (type(b) != type(j) || std::abs((xyz(a) - xyz(b)).norm() - ij) > near) continue;
        for (std::size_t c = 0; c < n && tried < kMostMotions; ++c) {
          Eigen::Matrix3d G;
          if (type(c) != type(k) || std::abs((xyz(a) - xyz(c)).norm() - ik) > near ||
              std::abs((xyz(b) - xyz(c)).norm() - jk) > near ||
              !axes_of(xyz(a), xyz(b), xyz(c), G)) {
            continue;
          }
          ++tried;
          Motion motion;
          motion.T = Eigen::Isometry3d::Identity();
          motion.T.linear() = G * F.transpose();
          motion.T.translation() = xyz(a) - motion.T.linear() * xyz(i);
          if (is_symmetry(model, motion.T, near)) continue;
          motion.carried = count_carried(model, motion.T, near);
          if (motion.carried < need) continue;
          const Eigen::Vector3d w = motion.T.linear().eulerAngles(2, 1, 0);
          const Eigen::Vector3d t = motion.T.translation() / (10.0 * near);
          found.emplace(std::array<long, 6>{std::lround(w.x() * 50),
                                            std::lround(w.y() * 50),
                                            std::lround(w.z() * 50),
                                            std::lround(t.x()),
                                            std::lround(t.y()),
                                            std::lround(t.z())},
                        motion);
        }
      }
    }
  }
  std::vector<Motion> motions;
  for (const auto& [key, motion] : found) motions.push_back(motion);
  std::stable_sort(motions.begin(), motions.end(), [](const Motion& a, const Motion& b) {
    return a.carried > b.carried;
  });
  for (const Motion& motion : motions) {
    if (result.size() == most) break;
    result.push_back(motion.T);
  }
  return result;
}

}  // namespace landmarkdb
