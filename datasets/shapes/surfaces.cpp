#include <algorithm>
#include <cmath>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

// Cell borders of a wall along one axis: its ends and those of the openings.
std::vector<double> borders(double length, const std::vector<double>& inner) {
  std::vector<double> all = {0.0, length};
  for (const double x : inner) all.push_back(std::clamp(x, 0.0, length));
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

void add_face(TriangleMesh& mesh,
              const Eigen::Isometry3d& T,
              double x0,
              double x1,
              double z0,
              double z1,
              double y,
              bool towards_minus_y) {
  const Eigen::Vector3d a = T * Eigen::Vector3d(x0, y, z0);
  const Eigen::Vector3d b = T * Eigen::Vector3d(x1, y, z0);
  const Eigen::Vector3d c = T * Eigen::Vector3d(x1, y, z1);
  const Eigen::Vector3d d = T * Eigen::Vector3d(x0, y, z1);
  if (towards_minus_y) {
    add_quad(mesh, a, b, c, d);
  } else {
    add_quad(mesh, d, c, b, a);
  }
}

// The four sides of a hole, looking into it.
void add_reveals(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Opening& o, double depth) {
  const auto p = [&](double x, double y, double z) -> Eigen::Vector3d {
    return T * Eigen::Vector3d(x, y, z);
  };
  add_quad(mesh, p(o.x0, 0, o.z0), p(o.x0, depth, o.z0), p(o.x0, depth, o.z1), p(o.x0, 0, o.z1));
  add_quad(mesh, p(o.x1, 0, o.z1), p(o.x1, depth, o.z1), p(o.x1, depth, o.z0), p(o.x1, 0, o.z0));
  add_quad(mesh, p(o.x0, 0, o.z1), p(o.x0, depth, o.z1), p(o.x1, depth, o.z1), p(o.x1, 0, o.z1));
  add_quad(mesh, p(o.x0, 0, o.z0), p(o.x1, 0, o.z0), p(o.x1, depth, o.z0), p(o.x0, depth, o.z0));
}

}  // namespace

void add_wall(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Wall& wall) {
  const std::size_t wall_object = mesh.objects.empty() ? 0 : mesh.objects.size() - 1;
  std::vector<double> xs, zs;
  for (const Opening& o : wall.openings) {
    xs.insert(xs.end(), {o.x0, o.x1});
    zs.insert(zs.end(), {o.z0, o.z1});
  }
  xs = borders(wall.length_m, xs);
  zs = borders(wall.height_m, zs);
  const auto open_at = [&](double x, double z, bool back) {
    return std::any_of(wall.openings.begin(), wall.openings.end(), [&](const Opening& o) {
      return x > o.x0 && x < o.x1 && z > o.z0 && z < o.z1 && (!back || o.through);
    });
  };
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t k = 0; k + 1 < zs.size(); ++k) {
      const double x = 0.5 * (xs[i] + xs[i + 1]);
      const double z = 0.5 * (zs[k] + zs[k + 1]);
      if (!open_at(x, z, false)) add_face(mesh, T, xs[i], xs[i + 1], zs[k], zs[k + 1], 0.0, true);
      if (wall.thickness_m > 0.0 && !open_at(x, z, true)) {
        add_face(mesh, T, xs[i], xs[i + 1], zs[k], zs[k + 1], wall.thickness_m, false);
      }
    }
  }
  if (wall.thickness_m > 0.0) {  // ends and top
    const Opening rim{0.0, wall.length_m, 0.0, wall.height_m};
    const auto p = [&](double x, double y, double z) -> Eigen::Vector3d {
      return T * Eigen::Vector3d(x, y, z);
    };
    const double t = wall.thickness_m;
    const double h = rim.z1;
    add_quad(mesh, p(0, 0, h), p(0, t, h), p(0, t, 0), p(0, 0, 0));
    add_quad(mesh, p(rim.x1, 0, 0), p(rim.x1, t, 0), p(rim.x1, t, h), p(rim.x1, 0, h));
    add_quad(mesh, p(0, 0, h), p(rim.x1, 0, h), p(rim.x1, t, h), p(0, t, h));
  }
  for (const Opening& o : wall.openings) {
    add_reveals(mesh, T, o, o.through ? wall.thickness_m : o.depth_m);
  }
  const std::string name = mesh.objects.empty() ? "wall" : mesh.objects[wall_object].name;
  for (const Opening& o : wall.openings) {
    if (o.through) continue;
    begin_object(mesh, name + " pane", o.material);
    add_face(mesh, T, o.x0, o.x1, o.z0, o.z1, o.depth_m, true);
  }
}

void add_sheet(TriangleMesh& mesh,
               const Eigen::Isometry3d& T,
               const Eigen::Vector2d& size,
               double step_m,
               const std::function<double(double, double)>& height) {
  const int columns = std::max(1, static_cast<int>(std::ceil(size.x() / step_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil(size.y() / step_m)));
  const auto point = [&](int i, int k) -> Eigen::Vector3d {
    const double x = size.x() * i / columns;
    const double y = size.y() * k / rows;
    return T * Eigen::Vector3d(x, y, height(x, y));
  };
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < rows; ++k) {
      add_quad(mesh, point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1));
    }
  }
}

double smooth_noise(const Eigen::Vector3d& p, std::uint64_t seed) {
  const Eigen::Vector3d base = p.array().floor();
  const Eigen::Vector3d t = p - base;
  const Eigen::Vector3d s = t.array().square() * (3.0 - 2.0 * t.array());
  const auto lattice = [&](int i) {
    std::uint64_t hash = seed;
    for (int k = 0; k < 3; ++k) {
      const auto cell = static_cast<std::int64_t>(base[k]) + ((i >> k) & 1);
      hash = Random(hash ^ (static_cast<std::uint64_t>(cell) + 0x9e37U)).next();
    }
    return 2.0 * Random(hash).uniform() - 1.0;
  };
  double sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    double weight = 1.0;
    for (int k = 0; k < 3; ++k) weight *= ((i >> k) & 1) != 0 ? s[k] : 1.0 - s[k];
    sum += weight * lattice(i);
  }
  return sum;
}

}  // namespace landmarkdb::datasets
