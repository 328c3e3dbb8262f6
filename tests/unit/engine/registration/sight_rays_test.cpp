#include "engine/registration/sight_rays.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/registration/equal_angles.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

struct Task {
  std::vector<Eigen::Vector3f> points, normals;
  SightView view;

  explicit Task(std::size_t count) {
    Random random(count + 1);
    const Eigen::Isometry3d T = testing::random_pose(random, 1.0, 3.0);
    view = {T.linear().cast<float>(),
            T.translation().cast<float>(),
            Eigen::Vector3f(0.6F, 0, 0.8F),
            -0.3F,
            5.0F,
            90};
    const auto number = [&] { return static_cast<float>(random.normal()); };
    const auto any = [&]() -> Eigen::Vector3f { return {number(), number(), number()}; };
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back(2.0F * any());
      normals.push_back(any().normalized());
    }
    if (count > 3) points[3] = -(view.R_view_surface.transpose() * view.t_view_surface);
  }

  std::vector<SightRay> look(SightKernel kernel, bool with_normals = true) const {
    std::vector<SightRay> rays(points.size());
    kernel(points[0].data(),
           with_normals ? normals[0].data() : nullptr,
           points.size(),
           view,
           rays.data());
    return rays;
  }
};

int cell_of(double tangent, int side) {
  const double share = std::atan(tangent) / (0.5 * std::numbers::pi) + 0.5;
  return std::min(static_cast<int>(share * side), side - 1);
}

TEST(SightRays, AreWhatPlainArithmeticMakesOfThem) {
  const Task task(500);
  const std::vector<SightRay> rays = task.look(sight_kernel());
  std::size_t seen = 0;
  std::size_t beside = 0;  // a cell off, at a cell's edge
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3f ray =
        task.view.R_view_surface * task.points[i] + task.view.t_view_surface;
    const float range = ray.norm();
    const bool in_view = range > 1e-5F && range <= task.view.reach_m &&
                         task.view.cone_axis.dot(ray) >= task.view.cone_cosine * range;
    ASSERT_EQ(rays[i].range_m > 1e-5F, in_view) << i;
    if (!in_view) continue;
    ++seen;
    EXPECT_NEAR(rays[i].range_m, range, 1e-5F);
    EXPECT_EQ(rays[i].back != 0, ray.dot(task.view.R_view_surface * task.normals[i]) > 0.0F);
    int axis = 0;
    const auto size = static_cast<double>(ray.cwiseAbs().maxCoeff(&axis));
    EXPECT_EQ(rays[i].place >> 24, 2 * axis + (ray[axis] < 0.0F ? 1 : 0));
    const int row = cell_of(static_cast<double>(ray[(axis + 1) % 3]) / size, task.view.side);
    const int column = cell_of(static_cast<double>(ray[(axis + 2) % 3]) / size, task.view.side);
    const int off = std::abs(((rays[i].place >> 12) & 0xfff) - row) +
                    std::abs((rays[i].place & 0xfff) - column);
    EXPECT_LE(off, 1);
    beside += off == 0 ? 0U : 1U;
  }
  EXPECT_GT(seen, 200U);
  EXPECT_LE(beside, 3U);
}

TEST(SightRays, AreTheSameOnEveryInstructionSet) {
  for (const std::size_t count : {1U, 15U, 16U, 17U, 128U}) {
    const Task task(count);
    for (const bool with_normals : {false, true}) {
      const std::vector<SightRay> base = task.look(sight_kernel("sse2"), with_normals);
      for (const char* name : {"avx2", "avx512"}) {
        const SightKernel kernel = sight_kernel(name);
        if (kernel == nullptr) continue;
        const std::vector<SightRay> rays = task.look(kernel, with_normals);
        EXPECT_EQ(std::memcmp(rays.data(), base.data(), count * sizeof(SightRay)), 0) << name;
      }
    }
  }
  EXPECT_EQ(sight_kernel("none"), nullptr);
}

TEST(AlongFace, IsTheAnglesShareOfTheFace) {
  for (double tangent = -1.0; tangent <= 1.0; tangent += 0.01) {
    EXPECT_NEAR(along_face(static_cast<float>(tangent)),
                std::atan(tangent) / (0.5 * std::numbers::pi) + 0.5,
                1e-5);
  }
}

}  // namespace
}  // namespace landmarkdb
