#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "engine/mono/model_draft.hpp"
#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::read_text;
using testing::refusal_of;
using ::testing::SizeIs;

struct Obj {
  std::ostringstream text{};
  int vertices = 0;
  int vertex(double x, double y, double z) {
    text << "v " << x << ' ' << y << ' ' << z << '\n';
    return ++vertices;
  }
  void face(const std::vector<int>& corners) {
    text << 'f';
    for (const int corner : corners) text << ' ' << corner;
    text << '\n';
  }
};

// A box whose sides are grids of n x n squares, each cut in two, with vertices of its own.
std::string fine_box(int n) {
  Obj obj;
  const auto side = [&](Eigen::Vector3d origin, Eigen::Vector3d u, Eigen::Vector3d v) {
    const int base = obj.vertices + 1;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) {
        const Eigen::Vector3d p = origin + u * i / n + v * j / n;
        obj.vertex(p.x(), p.y(), p.z());
      }
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const int a = base + i * (n + 1) + j;
        obj.face({a, a + n + 1, a + n + 2});
        obj.face({a, a + n + 2, a + 1});
      }
    }
  };
  const Eigen::Vector3d x(0.12, 0, 0), y(0, 0.08, 0), z(0, 0, 0.06), o(0, 0, 0);
  side(o, y, x);
  side(z, x, y);
  side(o, x, z);
  side(y, z, x);
  side(o, z, y);
  side(x, y, z);
  return obj.text.str();
}

std::string cylinder(int n) {
  Obj obj;
  std::vector<int> low, high;
  for (int k = 0; k < n; ++k) {
    const double a = 2.0 * std::numbers::pi * k / n;
    low.push_back(obj.vertex(0.03 * std::cos(a), 0.03 * std::sin(a), 0.0));
    high.push_back(obj.vertex(0.03 * std::cos(a), 0.03 * std::sin(a), 0.1));
  }
  for (std::size_t k = 0; k < low.size(); ++k) {
    const std::size_t l = (k + 1) % low.size();
    obj.face({low[k], low[l], high[l], high[k]});
  }
  obj.face({low.rbegin(), low.rend()});
  obj.face(high);
  return obj.text.str();
}

TEST(ParseMeshModel, JoinsTheTrianglesOfOnePlane) {
  for (const int n : {1, 3, 41}) {  // 41: 10,584 vertices
    const auto read = read_text(fine_box(n), "box.obj");
    EXPECT_THAT(read.model.faces, SizeIs(6)) << n;
    EXPECT_THAT(read.model.edges, SizeIs(12)) << n;
    EXPECT_THAT(read.model.points, SizeIs(8 + 6)) << n;
    EXPECT_EQ(read.model.symmetry_class, "d2") << n;
    EXPECT_THAT(read.warnings, ::testing::IsEmpty()) << n;
  }
}

TEST(ParseMeshModel, ReadsAPlyPolyhedron) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n100 0 0\n0 100 0\n0 0 100\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  const MonoModel model = read_text(ply, "corner.ply", {.units = Units::kMillimetres}).model;
  EXPECT_THAT(model.edges, SizeIs(6));
  EXPECT_NEAR(model.diameter_m, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(model.symmetry_class, "c3");
}

TEST(ParseMeshModel, MakesCirclesOfRoundRims) {
  const auto read = read_text(cylinder(32), "can.obj");
  ASSERT_THAT(read.model.circles, SizeIs(2));
  EXPECT_NEAR(read.model.circles[0].radius_m, 0.03, 1e-6);
  EXPECT_NEAR(read.model.circles[0].normal.z() * read.model.circles[1].normal.z(), -1.0, 1e-6);
  EXPECT_GT(read.model.circles[0].normal.z() * (read.model.circles[0].center.z() - 0.05), 0.0);
  EXPECT_EQ(read.model.symmetry_class, "revolution");
  EXPECT_THAT(read.model.faces, SizeIs(0));
  EXPECT_THAT(read.warnings, Contains(HasSubstr("32 pieces of curved surfaces")));
}

TEST(ParseMeshModel, KeepsHolesInFaces) {
  Obj obj;
  for (const double r : {0.05, 0.03}) {
    for (const double z : {0.0, 0.1}) {
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        obj.vertex(r * x, r * y, z);
      }
    }
  }
  for (int k = 0; k < 4; ++k) {
    const int l = (k + 1) % 4;
    obj.face({1 + k, 1 + l, 5 + l, 5 + k});
    obj.face({9 + l, 9 + k, 13 + k, 13 + l});
    obj.face({5 + k, 5 + l, 13 + l, 13 + k});
    obj.face({1 + l, 1 + k, 9 + k, 9 + l});
  }
  const auto read = read_text(obj.text.str(), "tube.obj");
  EXPECT_THAT(read.model.faces, SizeIs(10));
  EXPECT_THAT(read.model.edges, SizeIs(24));  // no bridges among them
  EXPECT_EQ(read.model.symmetry_class, "d4");
  EXPECT_THAT(read.warnings, ::testing::IsEmpty());
}

TEST(ParseMeshModel, RefusesMeshesOfTooManyCornersWithTheLimit) {
  Obj obj;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j)
      obj.vertex(i * 0.01, j * 0.01, 0.02 * ((i * i * 7 + j * j * 13 + i * j) % 5));
  }
  for (int i = 0; i < 39; ++i) {
    for (int j = 0; j < 39; ++j) {
      const int a = 1 + i * 40 + j;
      obj.face({a, a + 40, a + 41});
      obj.face({a, a + 41, a + 1});
    }
  }
  EXPECT_THAT(refusal_of(obj.text.str(), "rubble.obj"), HasSubstr("want at most 256"));
}

TEST(ParseMeshModel, RefusesWhatShowsNoCorner) {
  Obj obj;
  constexpr int kRings = 40;
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < 2 * kRings; ++j) {
      const double a = std::numbers::pi * i / kRings;
      const double b = std::numbers::pi * j / kRings;
      obj.vertex(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    }
  }
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < 2 * kRings; ++j) {
      const int a = 1 + i * 2 * kRings + j;
      const int b = 1 + i * 2 * kRings + (j + 1) % (2 * kRings);
      obj.face({a, a + 2 * kRings, b + 2 * kRings, b});
    }
  }
  EXPECT_THAT(refusal_of(obj.text.str(), "ball.obj"), HasSubstr("no corners and no round rims"));
}

TEST(ParseMeshModel, RefusesBadMeshes) {
  EXPECT_THAT(refusal_of("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj"), HasSubstr("no faces"));
  EXPECT_THAT(refusal_of("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj"), HasSubstr("vertex 0"));
  EXPECT_THAT(refusal_of("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj"),
              HasSubstr("no face with an area"));
  EXPECT_THAT(refusal_of("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "a.obj"),
              HasSubstr("at one place"));
}

}  // namespace
}  // namespace landmarkdb
