#include "engine/mono/face_rival.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/geometry/pose.hpp"
#include "engine/mono/point_pose.hpp"

namespace landmarkdb {
namespace {

// Of the diameter: how well a body's corners follow its model, and how far a face stands from its
// model's place in this body and in another one of its kind (sigmas).
constexpr double kTolerance = 0.005, kSame = 0.003, kOther = 0.1;
constexpr double kHuber = 2.0;
constexpr double kEdgeSigma_px = 0.7;
constexpr double kEdgesTogether = 8.0;  // neighbouring samples of an edge are off together
constexpr int kSteps = 3;
constexpr std::size_t kMostFaces = 64;
constexpr Eigen::Index kPose = 6;  // unknowns: turn, shift; those after them are faces

using Faces = std::vector<std::uint32_t>;

// How a place moves when faces move along their normals, metres a metre.
using Motion = std::vector<std::pair<std::uint32_t, Eigen::Vector3d>>;

class FaceSolver {
 public:
  FaceSolver(const SearchModel& model, const Camera& camera, const RigidPose& pose)
      : model_(model), camera_(camera), pose_(pose), of_edges_(model.model().edges.size()) {
    const MonoModel& m = model.model();
    for (const auto& face : m.faces) normals_.push_back(normal_of(m, face));
    const double focal = 0.5 * (std::abs(camera.fx) + std::abs(camera.fy));
    tolerance_px_ = kTolerance * focal * m.diameter_m / (pose * model.center).z();
    offsets_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m.faces.size()));
    const Eigen::Index n = kPose + offsets_.size();
    H_.resize(n, n);
    g_.resize(n);
  }

  bool step(std::span<const SeenCorner> corners, std::span<const SeenEdge> edges) {
    H_.setZero();
    g_.setZero();
    for (const SeenCorner& corner : corners) {
      if (!add_corner(corner)) return false;
    }
    for (const SeenEdge& edge : edges) {
      if (!add_edge(edge)) return false;
    }
    const double information = 1.0 / other_m2();
    Eigen::MatrixXd damped = H_;
    damped.diagonal().head(kPose) *= 1.0 + 1e-6;
    damped.diagonal().tail(offsets_.size()).array() += information;
    Eigen::VectorXd g = g_;
    g.tail(offsets_.size()) += information * offsets_;
    const Eigen::VectorXd x = -damped.ldlt().solve(g);
    if (!x.allFinite()) return false;
    pose_.R = rotation_from_vector(x.head<3>()) * pose_.R;
    pose_.t += x.segment<3>(3);
    offsets_ += x.tail(offsets_.size());
    return offsets_.cwiseAbs().maxCoeff() < model_.model().diameter_m;
  }

  // Of the faces' places as the image alone has them, by its own axes: those that it does not see
  // have no information and cancel.
  double log10_odds() const {
    const Eigen::Index n = offsets_.size();
    const Eigen::MatrixXd both = H_.topRightCorner(kPose, n);
    const Eigen::MatrixXd through = H_.topLeftCorner(kPose, kPose).ldlt().solve(both).transpose();
    Eigen::MatrixXd A = H_.bottomRightCorner(n, n) - through * both;
    A = 0.5 * (A + A.transpose().eval());
    const Eigen::VectorXd h = A * before_ - (g_.tail(n) - through * g_.head(kPose));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(A);
    const Eigen::VectorXd along = axes.eigenvectors().transpose() * h;
    const double diameter = model_.model().diameter_m;
    const double same = kSame * kSame * diameter * diameter, other = other_m2();
    double odds = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double seen = std::max(0.0, axes.eigenvalues()[i]);
      const double as_same = 1.0 + same * seen, as_other = 1.0 + other * seen;
      odds += std::log(as_other / as_same) -
              along[i] * along[i] * (other - same) / (as_same * as_other);
    }
    odds *= 0.5 / std::numbers::ln10;
    return std::isfinite(odds) ? odds : 0.0;
  }

  void keep() { before_ = offsets_; }

 private:
  static Eigen::Vector3d normal_of(const MonoModel& model, const Faces& face) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < face.size(); ++i) {
      const Eigen::Vector3d& here = model.points[face[i]].xyz;
      sum += here.cross(model.points[face[(i + 1) % face.size()]].xyz);
    }
    return sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
  }

  double other_m2() const {
    const double other = kOther * model_.model().diameter_m;
    return other * other;
  }

  template <typename Wanted>
  Faces faces_with(const Wanted& wanted) const {
    Faces found;
    const auto& faces = model_.model().faces;
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      if (wanted(faces[f])) found.push_back(f);
    }
    return found;
  }

  static bool has(const Faces& face, std::uint32_t point) {
    return std::find(face.begin(), face.end(), point) != face.end();
  }

  // Of the place where faces meet.
  Motion motion_where(const Faces& meeting) const {
    constexpr double kFree = 1e-9;  // along what the faces do not fix, nothing moves
    Eigen::Matrix3d A = kFree * Eigen::Matrix3d::Identity();
    for (const std::uint32_t f : meeting) A += normals_[f] * normals_[f].transpose();
    const Eigen::Matrix3d inverse = A.inverse();
    Motion motion;
    for (const std::uint32_t f : meeting) motion.emplace_back(f, inverse * normals_[f]);
    return motion;
  }

  Motion motion_of_point(std::uint32_t point) const {
    const ModelFeature& feature = model_.model().points[point];
    if (feature.type == FeatureType::kVertex)
      return motion_where(faces_with([&](const Faces& face) { return has(face, point); }));
    if (feature.type == FeatureType::kCentroid && feature.part >= 0) {
      const auto face = static_cast<std::uint32_t>(feature.part);
      return {{face, normals_[face]}};
    }
    if (!feature.normal) return {};
    constexpr double kParallel = 0.999, kInPlane = 0.002;
    const auto on = faces_with([&](const Faces& face) {
      const auto f = static_cast<std::size_t>(&face - model_.model().faces.data());
      const Eigen::Vector3d off = feature.xyz - model_.model().points[face.front()].xyz;
      return std::abs(normals_[f].dot(*feature.normal)) > kParallel &&
             std::abs(normals_[f].dot(off)) < kInPlane * model_.model().diameter_m;
    });
    if (on.empty()) return {};
    return {{on.front(), normals_[on.front()]}};
  }

  const Motion& motion_of_edge(std::uint32_t line) {
    std::optional<Motion>& known = of_edges_[line];
    if (known) return *known;
    const auto& [a, b] = model_.model().edges[line];
    known =
        motion_where(faces_with([&](const Faces& face) { return has(face, a) && has(face, b); }));
    return *known;
  }

  Eigen::Vector3d moved(const Eigen::Vector3d& place, const Motion& motion) const {
    Eigen::Vector3d result = place;
    for (const auto& [f, way] : motion) result += offsets_[f] * way;
    return result;
  }

  struct Slopes {
    Eigen::Vector2d uv;
    Eigen::Matrix<double, 2, kPose> of_pose;
    std::vector<Eigen::Vector2d> of_faces;  // in the motion's order
  };

  bool slopes(const Eigen::Vector3d& place, const Motion& motion, Slopes& result) const {
    const Eigen::Vector3d rho = pose_.R * moved(place, motion), X = rho + pose_.t;
    if (!(X.z() > 0.0)) return false;
    const Eigen::Vector2d ray = X.head<2>() / X.z();
    if (!inside_lens_model(camera_, ray)) return false;
    const LensPoint lens = distort_with_slope(camera_, ray);
    result.uv = lens.uv;
    Eigen::Matrix<double, 2, 3> D;
    D << 1.0 / X.z(), 0.0, -ray.x() / X.z(), 0.0, 1.0 / X.z(), -ray.y() / X.z();
    D = (lens.duv_dray * D).eval();
    Eigen::Matrix3d turn;
    turn << 0.0, rho.z(), -rho.y(), -rho.z(), 0.0, rho.x(), rho.y(), -rho.x(), 0.0;
    result.of_pose.leftCols<3>() = D * turn;
    result.of_pose.rightCols<3>() = D;
    result.of_faces.clear();
    for (const auto& [f, way] : motion) result.of_faces.push_back(D * (pose_.R * way));
    return true;
  }

  // One equation: `across` (unit) of the residual.
  void add(const Slopes& slope,
           const Motion& motion,
           const Eigen::Vector2d& across,
           double residual,
           double weight) {
    row_.resize(kPose + static_cast<Eigen::Index>(motion.size()));
    row_.head<kPose>() = slope.of_pose.transpose() * across;
    const auto column = [&](Eigen::Index i) {
      return i < kPose ? i : kPose + motion[static_cast<std::size_t>(i - kPose)].first;
    };
    for (std::size_t k = 0; k < motion.size(); ++k)
      row_[kPose + static_cast<Eigen::Index>(k)] = slope.of_faces[k].dot(across);
    for (Eigen::Index i = 0; i < row_.size(); ++i) {
      const double weighted = weight * row_[i];
      g_[column(i)] += weighted * residual;
      for (Eigen::Index k = 0; k < row_.size(); ++k) H_(column(i), column(k)) += weighted * row_[k];
    }
  }

  double huber(double r, double sigma2) const {
    const double bound = kHuber * std::sqrt(sigma2);
    return r <= bound ? 1.0 : bound / r;
  }

  bool add_corner(const SeenCorner& corner) {
    const Motion motion = motion_of_point(corner.point);
    PosePoint point = model_.points[corner.point];
    Slopes slope;
    if (!slopes(point.xyz, motion, slope)) return false;
    point.xyz = moved(point.xyz, motion);
    const SeenRay seen = seen_ray(point, pose_);
    if (!seen.ok) return false;
    const Eigen::Vector2d r = distort(camera_, seen.ray) - corner.uv;
    const double sigma2 = corner.sigma_px * corner.sigma_px + tolerance_px_ * tolerance_px_;
    const double weight = huber(r.norm(), sigma2) / sigma2;
    add(slope, motion, Eigen::Vector2d::UnitX(), r.x(), weight);
    add(slope, motion, Eigen::Vector2d::UnitY(), r.y(), weight);
    return true;
  }

  bool add_edge(const SeenEdge& edge) {
    const Motion& motion = motion_of_edge(edge.sample.line);
    Slopes slope;
    if (!slopes(edge.sample.xyz, motion, slope)) return false;
    const double r = edge.sample.normal.dot(slope.uv - edge.uv);
    const double sigma2 = kEdgeSigma_px * kEdgeSigma_px + tolerance_px_ * tolerance_px_;
    add(slope,
        motion,
        edge.sample.normal,
        r,
        huber(std::abs(r), sigma2) / (sigma2 * kEdgesTogether));
    return true;
  }

  const SearchModel& model_;
  const Camera& camera_;
  RigidPose pose_;
  std::vector<Eigen::Vector3d> normals_;         // of the faces
  std::vector<std::optional<Motion>> of_edges_;  // as far as they were asked for
  double tolerance_px_ = 0.0;
  Eigen::VectorXd offsets_, before_, g_, row_;
  Eigen::MatrixXd H_;
};

}  // namespace

std::optional<double> face_rival(const SearchModel& model,
                                 const Camera& camera,
                                 const RigidPose& pose,
                                 std::span<const SeenCorner> corners,
                                 std::span<const SeenEdge> edges) {
  const std::size_t faces = model.model().faces.size();
  if (corners.empty() || faces == 0 || faces > kMostFaces) return std::nullopt;
  if (!((pose * model.center).z() > 0.0)) return std::nullopt;
  FaceSolver solver(model, camera, pose);
  for (int i = 0; i < kSteps; ++i) {
    solver.keep();
    if (!solver.step(corners, edges)) return 0.0;
  }
  return solver.log10_odds();
}

}  // namespace landmarkdb
