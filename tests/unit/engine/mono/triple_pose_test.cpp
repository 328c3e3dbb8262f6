#include "engine/mono/triple_pose.hpp"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

using Points = std::array<Eigen::Vector3d, 3>;
using Rays = std::array<Eigen::Vector2d, 3>;

constexpr double kDegree = std::numbers::pi / 180.0;

ModelTriple triple_of(const Points& points) {
  ModelTriple triple;
  EXPECT_TRUE(complete_triple(points, triple));
  return triple;
}

double apart_deg(const RigidPose& a, const Eigen::Matrix3d& R) {
  return rotation_angle_rad(a.R.transpose() * R) / kDegree;
}

const Points kCorner{Eigen::Vector3d(0, 0, 0), {0.1, 0, 0}, {0, 0.1, 0}};

Eigen::Matrix3d random_rotation(Random& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

Eigen::Vector3d random_point(Random& random, double reach) {
  return {
      random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

TEST(SolveTriple, GivesBothPosesOfAWorkedTriple) {
  const ModelTriple triple =
      triple_of({Eigen::Vector3d(0.10, 0, 0.02), {-0.03, 0.08, 0}, {0, -0.06, 0.05}});
  const TriplePoses found = solve_triple(triple,
                                         {Eigen::Vector2d(0.095278935274, -0.013069814924),
                                          {-0.003729217747, 0.040225607256},
                                          {0.028450282473, -0.075155792333}});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  ASSERT_EQ(found.count, 2);
  EXPECT_NEAR(found.depth_m, 1.25, 1e-9);
  EXPECT_NEAR(found.cos_tilt, 0.897182296878, 1e-9);
  Eigen::Matrix3d one, other;
  one << 0.859533898559, -0.260226714048, -0.439867632958, 0.114916953936, 0.937032437285,
      -0.329794337692, 0.497991537003, 0.232921164284, 0.835315605207;
  other << 0.922107382363, 0.047426247990, 0.384016570467, 0.111091920343, 0.918226022118,
      -0.380157280005, -0.370643441364, 0.393206972608, 0.841434320709;
  const std::size_t first =
      (found.poses[0].R - one).norm() < (found.poses[1].R - one).norm() ? 0 : 1;
  EXPECT_LT((found.poses[first].R - one).norm(), 1e-9);
  EXPECT_LT((found.poses[1 - first].R - other).norm(), 1e-9);
  EXPECT_LT(
      (found.poses[first].t - Eigen::Vector3d(0.041942631896, -0.021233077294, 1.217336692253))
          .norm(),
      1e-9);
  EXPECT_LT(
      (found.poses[1 - first].t - Eigen::Vector3d(0.019207599447, -0.019843315089, 1.236393499665))
          .norm(),
      1e-9);
  EXPECT_NEAR(apart_deg(found.poses[0], found.poses[1].R), 52.419741017, 1e-6);
}

TEST(SolveTriple, GivesASquareOnTripleOnce) {
  const TriplePoses found =
      solve_triple(triple_of(kCorner), {Eigen::Vector2d(0, 0), {0.1, 0}, {0, 0.1}});
  ASSERT_EQ(found.status, PoseStatus::kOk);
  EXPECT_EQ(found.count, 1);
  EXPECT_DOUBLE_EQ(found.depth_m, 1.0);
  EXPECT_DOUBLE_EQ(found.cos_tilt, 1.0);
  EXPECT_LT((found.poses[0].R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((found.poses[0].t - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
}

TEST(SolveTriple, GivesTheMirroredTiltsOfASquashedTriple) {
  const TriplePoses found =
      solve_triple(triple_of(kCorner), {Eigen::Vector2d(0, 0), {0.1, 0}, {0, 0.05}});
  ASSERT_EQ(found.count, 2);
  EXPECT_NEAR(found.depth_m, 1.0, 1e-12);
  EXPECT_NEAR(found.cos_tilt, 0.5, 1e-12);
  const Eigen::Matrix3d back = rotation_from_vector({-60 * kDegree, 0, 0});
  const std::size_t first = apart_deg(found.poses[0], back) < 1.0 ? 0 : 1;
  EXPECT_LT((found.poses[first].R - back).norm(), 1e-9);
  EXPECT_NEAR(found.poses[first].t.z(), 1.028867513459, 1e-9);
  EXPECT_LT((found.poses[1 - first].R - back.transpose()).norm(), 1e-9);
  EXPECT_NEAR(found.poses[1 - first].t.z(), 0.971132486541, 1e-9);
}

TEST(SolveTriple, SaysWhenTheImagePointsAreCollinear) {
  const TriplePoses found =
      solve_triple(triple_of(kCorner), {Eigen::Vector2d(0, 0), {0.1, 0}, {0.05, 0}});
  EXPECT_EQ(found.status, PoseStatus::kCollinearImage);
  EXPECT_EQ(found.count, 2);
  EXPECT_NEAR(found.depth_m, 0.894427191, 1e-9);
}

TEST(SolveTriple, HasNoPoseForCoincidingImagePoints) {
  const Eigen::Vector2d at(0.1, 0.2);
  const TriplePoses found = solve_triple(triple_of(kCorner), {at, at, at});
  EXPECT_EQ(found.status, PoseStatus::kCollinearImage);
  EXPECT_EQ(found.count, 0);
}

TEST(SolveTriple, HasNoPoseForNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TriplePoses found =
      solve_triple(triple_of(kCorner), {Eigen::Vector2d(0, 0), {nan, 0}, {0, 0.1}});
  EXPECT_EQ(found.status, PoseStatus::kNotFinite);
  EXPECT_EQ(found.count, 0);
}

TEST(CompleteTriple, RefusesCollinearAndEqualPoints) {
  ModelTriple triple;
  EXPECT_FALSE(complete_triple({Eigen::Vector3d(0, 0, 0), {0.1, 0, 0}, {0.2, 0, 0}}, triple));
  EXPECT_FALSE(complete_triple({Eigen::Vector3d(0, 0, 0), {0.1, 0, 0}, {0.1, 0, 0}}, triple));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(complete_triple({Eigen::Vector3d(0, 0, nan), {0.1, 0, 0}, {0, 0.1, 0}}, triple));
  EXPECT_TRUE(complete_triple(kCorner, triple));
}

// Four thousand triples, seen by weak perspective itself, front and back.
TEST(SolveTriple, HasTheTruePoseAmongTheTwo) {
  Random random(1);
  int done = 0;
  while (done < 4000) {
    const Points points{
        random_point(random, 0.1), random_point(random, 0.1), random_point(random, 0.1)};
    ModelTriple triple;
    if (!complete_triple(points, triple) || triple.min_sin < 0.05) continue;
    const Eigen::Matrix3d R = random_rotation(random);
    const double s = random.uniform(0.5, 4.0);
    if (std::abs((R * triple.n).z()) < 0.05) continue;
    const Eigen::Vector2d center(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
    Rays rays;
    for (std::size_t i = 0; i < 3; ++i) {
      rays[i] = center + (R * (points[i] - triple.centroid)).head<2>() / s;
    }
    const TriplePoses found = solve_triple(triple, rays);
    ASSERT_EQ(found.status, PoseStatus::kOk);
    EXPECT_NEAR(found.depth_m, s, 1e-12 * s);
    EXPECT_EQ(found.from_front, (R * triple.n).z() < 0.0);
    double nearest = 180.0;
    for (int i = 0; i < found.count; ++i) {
      const RigidPose& pose = found.poses[static_cast<std::size_t>(i)];
      nearest = std::min(nearest, apart_deg(pose, R));
      EXPECT_LT((pose.R * pose.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    }
    EXPECT_LT(nearest, 1e-9) << "case " << done;
    ++done;
  }
}

struct Seen {
  Points points;
  ModelTriple triple;
  RigidPose truth;
  Rays rays;
};

Seen perspective_case(Random& random, double depth_m, double off_axis) {
  for (;;) {
    Seen seen;
    for (Eigen::Vector3d& point : seen.points) point = random_point(random, 0.1);
    if (!complete_triple(seen.points, seen.triple) || seen.triple.min_sin < 0.3) continue;
    seen.truth.R = random_rotation(random);
    if (std::abs((seen.truth.R * seen.triple.n).z()) < 0.4) continue;
    seen.truth.t = depth_m * Eigen::Vector3d(off_axis, off_axis, 1.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d X = seen.truth * seen.points[i];
      seen.rays[i] = X.head<2>() / X.z();
    }
    return seen;
  }
}

double nearest_deg(const TriplePoses& found, const RigidPose& truth) {
  double nearest = 180.0;
  for (int i = 0; i < found.count; ++i) {
    nearest = std::min(nearest, apart_deg(found.poses[static_cast<std::size_t>(i)], truth.R));
  }
  return nearest;
}

TEST(SolveTripleInSight, HalvesTheErrorOfWeakPerspectiveOffTheAxis) {
  Random random(2);
  double turned_sum = 0.0, plain_sum = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Seen seen = perspective_case(random, 2.0, 0.3);
    turned_sum += nearest_deg(solve_triple_in_sight(seen.triple, seen.rays), seen.truth);
    plain_sum += nearest_deg(solve_triple(seen.triple, seen.rays), seen.truth);
  }
  EXPECT_LT(turned_sum, 0.5 * plain_sum);
}

TEST(CorrectPerspective, ReachesAnExactPerspectivePose) {
  Random random(3);
  int exact = 0;
  constexpr int kCases = 300;
  for (int i = 0; i < kCases; ++i) {
    const Seen seen = perspective_case(random, 1.0, 0.2);
    const TriplePoses start = solve_triple_in_sight(seen.triple, seen.rays);
    bool fits = false;
    for (int branch = 0; branch < start.count; ++branch) {
      const RigidPose pose = correct_perspective(
          seen.triple, seen.points, seen.rays, start.poses[static_cast<std::size_t>(branch)], 60);
      double worst = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3d X = pose * seen.points[k];
        worst = std::max(worst, (X.head<2>() / X.z() - seen.rays[k]).norm());
      }
      fits = fits || worst < 1e-9;
    }
    exact += fits ? 1 : 0;
  }
  EXPECT_GE(exact, kCases * 95 / 100);  // Section "perspective correction": 98.5 % at 1 m
}

}  // namespace
}  // namespace landmarkdb
