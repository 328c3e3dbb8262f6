#include "engine/mono/point_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/model_faces.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Camera bent_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.dist[0] = -0.25;
  return camera;
}

Camera pinhole() {
  Camera camera = bent_camera();
  camera.dist[0] = 0.0;
  return camera;
}

RigidPose cube_pose() {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  return {R, Eigen::Vector3d(0.05, -0.04, 1.0)};
}

const std::vector<Eigen::Vector2d> kCubePixels{{348.8065711988, 157.2138159726},
                                               {348.658684126, 116.9184565159},
                                               {257.8797927949, 245.7308021853},
                                               {272.5387785927, 193.1430013545},
                                               {442.6986398331, 243.8272481743},
                                               {427.4909363299, 191.1648936028},
                                               {350.8945450011, 320.434045441},
                                               {350.7310047019, 259.3412478767}};

std::vector<PosePoint> cube(bool rounded) {
  std::vector<PosePoint> points;
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.1, 0.1}) {
      for (const double z : {-0.1, 0.1}) {
        PosePoint point;
        point.xyz = {x, y, z};
        point.uv = kCubePixels[points.size()];
        if (rounded) point.uv = point.uv.array().round();
        points.push_back(point);
      }
    }
  }
  return points;
}

double apart_rad(const RigidPose& a, const RigidPose& b) {
  return rotation_angle_rad(a.R.transpose() * b.R);
}

TEST(SolvePoints, FindsTheWorkedCubeExactly) {
  const PointPoses found = solve_points(cube(false), bent_camera(), {});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  EXPECT_LT(apart_rad(found.poses[0].pose, cube_pose()), 1e-9);
  EXPECT_LT((found.poses[0].pose.t - cube_pose().t).norm(), 1e-9);
}

TEST(SolvePoints, FindsTheMinimumOfTheRoundedCube) {
  const PointPoses found = solve_points(cube(true), bent_camera(), {});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  const PointPose& best = found.poses[0];
  EXPECT_LT((best.pose.t - Eigen::Vector3d(0.0503371689, -0.0402149143, 1.001308096)).norm(), 1e-8);
  EXPECT_NEAR(best.cost, 0.8484967526, 1e-8);
  EXPECT_NEAR(apart_rad(best.pose, cube_pose()) / kDegree, 0.08597910, 1e-6);
  EXPECT_NEAR((best.pose.t - cube_pose().t).norm(), 1.36783994e-3, 1e-9);
}

TEST(SolvePoints, PaysForALensModelThatIsLeftOut) {
  const PointPoses found = solve_points(cube(true), pinhole(), {});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  EXPECT_NEAR(found.poses[0].cost, 1.88042627, 1e-7);
  EXPECT_NEAR((found.poses[0].pose.t - cube_pose().t).norm(), 9.08405606e-3, 1e-8);
}

struct Problem {
  std::vector<PosePoint> points;
  RigidPose truth;
};

Problem random_problem(
    Random& random, const Camera& camera, std::size_t n, bool planar, double noise_px) {
  for (;;) {
    Problem problem;
    const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
    problem.truth.R = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
    problem.truth.t = {
        random.uniform(-0.15, 0.15), random.uniform(-0.1, 0.1), random.uniform(0.8, 1.2)};
    bool inside = !planar || std::abs(problem.truth.R(2, 2)) > 0.35;
    for (std::size_t i = 0; i < n; ++i) {
      PosePoint point;
      point.xyz = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
      if (planar) point.xyz.z() = 0.0;
      const std::optional<Eigen::Vector2d> uv = project(camera, problem.truth * point.xyz);
      inside = inside && uv;
      if (uv) point.uv = *uv + noise_px * Eigen::Vector2d(random.normal(), random.normal());
      problem.points.push_back(point);
    }
    if (inside) return problem;
  }
}

TEST(SolvePoints, IsExactOnExactPoints) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Problem problem = random_problem(random, bent_camera(), 10, i % 2 == 0, 0.0);
    const PointPoses found = solve_points(problem.points, bent_camera(), {});
    ASSERT_GT(found.count, 0);
    EXPECT_LT(apart_rad(found.poses[0].pose, problem.truth), 1e-7) << i;
    EXPECT_LT((found.poses[0].pose.t - problem.truth.t).norm(), 1e-7) << i;
  }
}

// Nothing unbiased is better than the minimum that the true pose leads to.
TEST(SolvePoints, ReachesTheMinimumThatTheTruthLeadsTo) {
  Random random(2);
  int other_minimum = 0;
  for (int i = 0; i < 200; ++i) {
    const Problem problem = random_problem(random, pinhole(), i % 2 == 0 ? 10 : 5, false, 0.5);
    const PointPoses found = solve_points(problem.points, pinhole(), {});
    const PointPoses bound = refine_points(problem.points, pinhole(), problem.truth, {});
    ASSERT_EQ(found.status, PoseStatus::kOk);
    if (apart_rad(found.poses[0].pose, bound.poses[0].pose) > 1e-4) ++other_minimum;
    EXPECT_LE(found.poses[0].cost, bound.poses[0].cost * 2.0 + 1e-6) << i;
  }
  EXPECT_LE(other_minimum, 2);
}

TEST(SolvePoints, SaysWhichPlanarPosesItCannotTellApart) {
  Random random(3);
  int wrong = 0, unsaid = 0;
  for (int i = 0; i < 300; ++i) {
    const Problem problem = random_problem(random, pinhole(), 8, true, 0.5);
    const PointPoses found = solve_points(problem.points, pinhole(), {});
    ASSERT_GT(found.count, 0);
    if (apart_rad(found.poses[0].pose, problem.truth) < 15 * kDegree) continue;
    ++wrong;
    const bool said = found.status == PoseStatus::kAmbiguous &&
                      apart_rad(found.poses[1].pose, problem.truth) < 15 * kDegree;
    unsaid += said ? 0 : 1;
  }
  EXPECT_LE(wrong, 6);
  EXPECT_EQ(unsaid, 0);
}

TEST(SolvePoints, GivesBothPosesOfASmallDistantSquare) {
  std::vector<PosePoint> points;
  const RigidPose truth{rotation_from_vector({0.5, 0.0, 0.0}), Eigen::Vector3d(0.0, 0.0, 5.0)};
  for (const double x : {-0.05, 0.05}) {
    for (const double y : {-0.05, 0.05}) {
      PosePoint point;
      point.xyz = {x, y, 0.0};
      point.uv = project(pinhole(), truth * point.xyz)->array().round();
      points.push_back(point);
    }
  }
  const PointPoses found = solve_points(points, pinhole(), {});
  EXPECT_EQ(found.status, PoseStatus::kAmbiguous);
  EXPECT_EQ(found.count, 2);
}

TEST(SolvePoints, DoesNotDependOnTheOrder) {
  Random random(4);
  Problem problem = random_problem(random, bent_camera(), 9, false, 0.5);
  const PointPoses one = solve_points(problem.points, bent_camera(), {});
  std::reverse(problem.points.begin(), problem.points.end());
  const PointPoses other = solve_points(problem.points, bent_camera(), {});
  EXPECT_LT(apart_rad(one.poses[0].pose, other.poses[0].pose), 1e-7);
}

// A circle of 0.05 m at 0.6 m, tilted by 45 degrees: its ellipse's centre is 2.0906 px off.
TEST(SeenRay, IsTheCentreOfTheEllipseOfACircle) {
  PosePoint circle;
  circle.radius_m = 0.05;
  const RigidPose pose{rotation_from_vector({45 * kDegree, 0, 0}), Eigen::Vector3d(0, 0, 0.6)};
  const SeenRay seen = seen_ray(circle, pose);
  ASSERT_TRUE(seen.ok);
  EXPECT_NEAR(std::abs(seen.ray.y()) * 600.0, 2.0906, 1e-4);
  EXPECT_NEAR(seen.ray.x(), 0.0, 1e-12);
}

TEST(SolvePoints, IsExactOnCentresOfEllipses) {
  std::vector<PosePoint> points;
  const RigidPose truth{rotation_from_vector({0.6, -0.3, 0.2}), Eigen::Vector3d(0.02, -0.03, 0.6)};
  for (const double x : {-0.1, 0.0, 0.1}) {
    for (const double y : {-0.1, 0.0, 0.1}) {
      PosePoint point;
      point.xyz = {x, y, 0.0};
      point.radius_m = 0.04;
      point.uv = distort(bent_camera(), seen_ray(point, truth).ray);
      points.push_back(point);
    }
  }
  const PointPoses found = solve_points(points, bent_camera(), {});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  EXPECT_LT(apart_rad(found.poses[0].pose, truth), 1e-8);
  for (PosePoint& point : points) point.radius_m = 0.0;
  const PointPoses biased = solve_points(points, bent_camera(), {});
  EXPECT_GT(apart_rad(biased.poses[0].pose, truth), 1e-3) << "the bias would be nothing to correct";
}

// A plate of 0.16 x 0.08 m with a corner cut out, and the centre of gravity of its image.
MonoModel plate() {
  MonoModel model;
  for (const auto& [x, y] : {std::pair{-0.08, -0.04},
                             {0.08, -0.04},
                             {0.08, 0.0},
                             {0.02, 0.0},
                             {0.02, 0.04},
                             {-0.08, 0.04}}) {
    model.points.push_back({FeatureType::kVertex, {x, y, 0.02}});
  }
  model.faces = {{0, 1, 2, 3, 4, 5}};
  model.points.push_back({FeatureType::kCentroid, area_centroid(model, model.faces[0]), {}, 0});
  model.diameter_m = 0.18;
  return model;
}

Eigen::Vector2d image_centroid(const MonoModel& model, const RigidPose& pose) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0.0;
  const std::vector<std::uint32_t>& face = model.faces[0];
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Eigen::Vector3d A = pose * model.points[face[i]].xyz;
    const Eigen::Vector3d B = pose * model.points[face[(i + 1) % face.size()]].xyz;
    const Eigen::Vector2d a = A.head<2>() / A.z(), b = B.head<2>() / B.z();
    const double part = a.x() * b.y() - a.y() * b.x();
    sum += part * (a + b) / 3.0;
    area += part;
  }
  return sum / area;
}

TEST(SeenRay, OfAFaceIsTheCentreOfGravityOfItsImage) {
  const MonoModel model = plate();
  const PosePoint centroid = pose_points(model).back();
  PosePoint plain;
  plain.xyz = centroid.xyz;
  Random random(3);
  double worst_px = 0.0, worst_plain_px = 0.0;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d turn(
        random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-3.0, 3.0));
    const RigidPose pose{rotation_from_vector(turn),
                         {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0.6}};
    if (pose.R(2, 2) < 0.5) continue;
    const Eigen::Vector2d seen = image_centroid(model, pose);
    const SeenRay ray = seen_ray(centroid, pose);
    ASSERT_TRUE(ray.ok);
    worst_px = std::max(worst_px, 600.0 * (ray.ray - seen).norm());
    worst_plain_px = std::max(worst_plain_px, 600.0 * (seen_ray(plain, pose).ray - seen).norm());
  }
  EXPECT_GT(worst_plain_px, 3.0) << "there would be nothing to correct";
  EXPECT_LT(worst_px, 0.5);
}

TEST(SolvePoints, IsExactOnCentroidsOfFaces) {
  // Nine plates that are turned in their plane, as seen_ray has them: the slopes lead to the truth.
  std::vector<PosePoint> points;
  const RigidPose truth{rotation_from_vector({0.6, -0.3, 0.2}), Eigen::Vector3d(0.02, -0.03, 0.6)};
  for (const double x : {-0.1, 0.0, 0.1}) {
    for (const double y : {-0.1, 0.0, 0.1}) {
      PosePoint point;
      point.xyz = {x, y, 0.0};
      point.radius_m = 0.02;
      point.longer = 0.05 * Eigen::Vector3d(std::cos(7.0 * x + y), std::sin(7.0 * x + y), 0.0);
      point.uv = distort(bent_camera(), seen_ray(point, truth).ray);
      points.push_back(point);
    }
  }
  const PointPoses found = solve_points(points, bent_camera(), {});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  EXPECT_LT(apart_rad(found.poses[0].pose, truth), 1e-8);
}

TEST(SolvePoints, ResistsAnOutlierWithHuber) {
  Random random(5);
  Problem problem = random_problem(random, pinhole(), 12, false, 0.3);
  problem.points[3].uv += Eigen::Vector2d(25.0, -15.0);
  PointPoseOptions robust;
  robust.huber = 2.0;
  const PointPoses plain = solve_points(problem.points, pinhole(), {});
  const PointPoses held = solve_points(problem.points, pinhole(), robust);
  EXPECT_LT(apart_rad(held.poses[0].pose, problem.truth),
            0.5 * apart_rad(plain.poses[0].pose, problem.truth));
}

// The covariance says how far answers scatter: the mean of d^T C^-1 d is six.
TEST(SolvePoints, HasACovarianceThatFitsTheScatter) {
  Random random(6);
  double sum = 0.0;
  constexpr int kCases = 300;
  for (int i = 0; i < kCases; ++i) {
    const Problem problem = random_problem(random, pinhole(), 12, false, 1.0);
    const PointPose found = solve_points(problem.points, pinhole(), {}).poses[0];
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(found.pose.R * problem.truth.R.transpose()));
    Eigen::Matrix<double, 6, 1> d;
    d << found.pose.t - problem.truth.t, turn.angle() * turn.axis();
    sum += d.dot(found.covariance.inverse() * d);
  }
  EXPECT_NEAR(sum / kCases, 6.0, 0.8);
}

TEST(SolvePoints, RefusesWhatHasNoPose) {
  std::vector<PosePoint> points = cube(false);
  EXPECT_EQ(solve_points(std::span(points).first(3), bent_camera(), {}).status,
            PoseStatus::kTooFewPoints);
  points[2].uv.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve_points(points, bent_camera(), {}).status, PoseStatus::kNotFinite);
  points[2].uv.x() = 5000.0;
  EXPECT_EQ(solve_points(points, bent_camera(), {}).status, PoseStatus::kOutsideLensModel);
  points = cube(false);
  for (PosePoint& point : points) point.xyz.y() = point.xyz.z() = 0.0;
  EXPECT_EQ(solve_points(points, bent_camera(), {}).status, PoseStatus::kCollinearModel);
  points = cube(false);
  for (PosePoint& point : points) point.uv = {100.0, 100.0};
  EXPECT_EQ(solve_points(points, bent_camera(), {}).count, 0);
  EXPECT_EQ(
      refine_points(
          cube(false), bent_camera(), {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, -1)}, {})
          .status,
      PoseStatus::kBehindCamera);
}

}  // namespace
}  // namespace landmarkdb
