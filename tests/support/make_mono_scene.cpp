#include "tests/support/make_mono_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb::testing {
namespace {

Eigen::Vector3d random_direction(Random& random) {
  for (;;) {
    const Eigen::Vector3d d(random.normal(), random.normal(), random.normal());
    if (d.norm() > 1e-3) return d.normalized();
  }
}

Eigen::Matrix3d random_rotation(Random& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

// Corners on an ellipsoid, apart from each other: all of them are corners of their hull.
void add_corners(Random& random, std::size_t n, std::size_t types, MonoModel& model) {
  const Eigen::Vector3d axes(
      random.uniform(0.06, 0.12), random.uniform(0.06, 0.12), random.uniform(0.06, 0.12));
  double apart = 0.06;
  while (model.points.size() < n) {
    ModelFeature point;
    point.xyz = axes.cwiseProduct(random_direction(random));
    point.type = static_cast<FeatureType>(random.below(types));
    const bool clear =
        std::none_of(model.points.begin(), model.points.end(), [&](const ModelFeature& p) {
          return (p.xyz - point.xyz).norm() < apart;
        });
    if (clear) model.points.push_back(point);
    apart *= 0.999;
  }
}

// The hull by brute force: a triple is a face where all other points lie behind it.
void add_faces(MonoModel& model) {
  const std::uint32_t n = static_cast<std::uint32_t>(model.points.size());
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = 0; b < n; ++b) {
      for (std::uint32_t c = 0; c < n; ++c) {
        if (b <= a || c <= a || b == c) continue;
        const Eigen::Vector3d& origin = model.points[a].xyz;
        const Eigen::Vector3d normal =
            (model.points[b].xyz - origin).cross(model.points[c].xyz - origin);
        bool outer = true;
        for (std::uint32_t k = 0; k < n && outer; ++k) {
          outer = k == a || k == b || k == c || normal.dot(model.points[k].xyz - origin) < 0.0;
        }
        if (outer) model.faces.push_back({a, b, c});
      }
    }
  }
}

void add_links(Random& random,
               const MonoModel& model,
               const std::vector<int>& image_of,
               double missing,
               MonoScene& scene) {
  for (const auto& [a, b] : model.edges) {
    if (image_of[a] < 0 || image_of[b] < 0 || random.uniform() < missing) continue;
    scene.features.links.push_back(
        {static_cast<std::uint32_t>(image_of[a]), static_cast<std::uint32_t>(image_of[b])});
  }
}

// Each clutter point is linked with some of the points around it.
void add_clutter_links(Random& random, std::size_t first, MonoScene& scene) {
  const std::vector<ImageFeature>& points = scene.features.points;
  std::set<std::array<std::uint32_t, 2>> links;
  for (std::size_t i = first; i < points.size(); ++i) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (k != i)
        near.emplace_back((points[k].uv - points[i].uv).norm(), static_cast<std::uint32_t>(k));
    }
    std::sort(near.begin(), near.end());
    const std::size_t reach = std::min<std::size_t>(6, near.size());
    for (std::size_t k = 0; k < reach; ++k) {
      if (random.uniform() > 0.3) continue;
      const std::uint32_t a = static_cast<std::uint32_t>(i), b = near[k].second;
      links.insert({std::min(a, b), std::max(a, b)});
    }
  }
  scene.features.links.insert(scene.features.links.end(), links.begin(), links.end());
}

void add_directions(Random& random,
                    const MonoModel* model,
                    const std::vector<int>& image_of,
                    MonoScene& scene) {
  constexpr double kNoise_rad = 3.0 * std::numbers::pi / 180.0;
  std::vector<ImageFeature>& points = scene.features.points;
  std::vector<bool> known(points.size(), false);
  if (model != nullptr) {
    const auto seen = [&](std::uint32_t i) {
      return project(scene.camera, scene.truth * model->points[i].xyz);
    };
    for (const auto& [a, b] : model->edges) {
      for (const auto& [from, to] : {std::array{a, b}, std::array{b, a}}) {
        if (image_of[from] < 0 || random.uniform() < 0.15) continue;
        const auto p = seen(from), q = seen(to);
        if (!p || !q) continue;
        const Eigen::Vector2d d = *q - *p;
        const std::size_t at = static_cast<std::size_t>(image_of[from]);
        points[at].directions.push_back(std::atan2(d.y(), d.x()) + kNoise_rad * random.normal());
        known[at] = true;
      }
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t count = known[i] ? 0 : 2 + random.below(2);
    for (std::size_t k = 0; k < count; ++k) {
      points[i].directions.push_back(random.uniform(-std::numbers::pi, std::numbers::pi));
    }
  }
}

void add_edge_line(Random& random,
                   const Eigen::Vector2d& from,
                   const Eigen::Vector2d& to,
                   double found,
                   MonoScene& scene) {
  const Eigen::Vector2d along = to - from;
  const double length = along.norm();
  if (length < 2.0) return;
  const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()) / length;
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  for (double at = 0.5; at < length; at += 1.0) {
    if (random.uniform() > found) continue;
    const Eigen::Vector2d uv = from + at / length * along + 0.3 * random.normal() * normal;
    const bool inside = uv.x() >= 0.0 && uv.y() >= 0.0 && uv.x() < scene.camera.width &&
                        uv.y() < scene.camera.height;
    if (inside) scene.features.edges.push_back({uv.cast<float>(), (side * normal).cast<float>()});
  }
}

void add_edges(Random& random, const MonoModel* model, MonoScene& scene) {
  if (model != nullptr) {
    const ModelVisibility visibility(*model);
    const Eigen::Vector3d eye = -(scene.truth.R.transpose() * scene.truth.t);
    for (const auto& [a, b] : model->edges) {
      const Eigen::Vector3d middle = 0.5 * (model->points[a].xyz + model->points[b].xyz);
      if (!visibility.place_seen_from(middle, eye)) continue;
      const auto p = project(scene.camera, scene.truth * model->points[a].xyz);
      const auto q = project(scene.camera, scene.truth * model->points[b].xyz);
      if (p && q) add_edge_line(random, *p, *q, 0.8, scene);
    }
  }
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d from(random.uniform(0, 640), random.uniform(0, 480));
    const double angle = random.uniform(0, 2 * std::numbers::pi), length = random.uniform(20, 150);
    add_edge_line(random,
                  from,
                  from + length * Eigen::Vector2d(std::cos(angle), std::sin(angle)),
                  0.9,
                  scene);
  }
}

}  // namespace

std::shared_ptr<const MonoModelRecord> make_mono_model(const MonoModelOptions& options) {
  Random random(options.seed);
  auto record = std::make_shared<MonoModelRecord>();
  MonoModel& model = record->model;
  const std::size_t n =
      options.least_points + random.below(options.most_points - options.least_points + 1);
  add_corners(random, n, options.types, model);
  add_faces(model);
  std::set<std::array<std::uint32_t, 2>> sides;
  for (const std::vector<std::uint32_t>& face : model.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      sides.insert({std::min(face[i], face[(i + 1) % 3]), std::max(face[i], face[(i + 1) % 3])});
    }
  }
  for (const auto& side : sides) {
    if (random.uniform() < options.share_of_edges) model.edges.push_back(side);
  }
  model.symmetries = {Eigen::Matrix4d::Identity()};
  for (const ModelFeature& p : model.points) {
    for (const ModelFeature& q : model.points) {
      model.diameter_m = std::max(model.diameter_m, (p.xyz - q.xyz).norm());
    }
  }
  return record;
}

std::shared_ptr<const MonoCatalog> make_mono_catalog(const MonoModelOptions& options,
                                                     std::size_t count) {
  auto catalog = std::make_shared<MonoCatalog>();
  for (std::size_t i = 0; i < count; ++i) {
    MonoModelOptions one = options;
    one.seed = options.seed + i;
    auto record = std::make_shared<MonoModelRecord>(*make_mono_model(one));
    record->model.name = "model" + std::to_string(i);
    catalog->entries.push_back({static_cast<std::int64_t>(i + 1), record, {}});
  }
  return catalog;
}

MonoScene make_mono_scene(const MonoModelRecord* record, const MonoSceneOptions& options) {
  Random random(options.seed * 7919 + 17);
  MonoScene scene;
  scene.camera.width = scene.features.width = 640;
  scene.camera.height = scene.features.height = 480;
  scene.camera.fx = scene.camera.fy = 600.0;
  scene.camera.cx = 320.0;
  scene.camera.cy = 240.0;
  const MonoModel* model = record == nullptr ? nullptr : &record->model;
  std::vector<int> image_of;
  const auto noise = [&]() -> Eigen::Vector2d {
    return options.noise_px * Eigen::Vector2d(random.normal(), random.normal());
  };
  if (model != nullptr) {
    scene.truth.R = random_rotation(random);
    const double z = random.uniform(options.near_m, options.far_m);
    scene.truth.t = z * Eigen::Vector3d(random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), 1.0);
    image_of.assign(model->points.size(), -1);
    const ModelVisibility visibility(*model);
    const std::vector<bool> seen =
        visibility.points_from(-(scene.truth.R.transpose() * scene.truth.t));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!seen[i] || random.uniform() < options.missing) continue;
      ImageFeature feature;
      feature.type = model->points[i].type;
      feature.uv = *project(scene.camera, scene.truth * model->points[i].xyz) + noise();
      if (feature.uv.x() < 0 || feature.uv.y() < 0 || feature.uv.x() > 639 || feature.uv.y() > 479)
        continue;
      image_of[i] = static_cast<int>(scene.features.points.size());
      scene.features.points.push_back(feature);
      scene.model_of.push_back(static_cast<std::uint32_t>(i));
    }
  }
  scene.true_features = scene.features.points.size();
  std::size_t total = options.features;
  if (options.clutter_share > 0.0) {
    total = static_cast<std::size_t>(
        std::lround(static_cast<double>(scene.true_features) / (1.0 - options.clutter_share)));
  }
  while (scene.features.points.size() < total) {
    ImageFeature feature;
    feature.type = static_cast<FeatureType>(random.below(options.types));
    feature.uv = {random.uniform(0, 639), random.uniform(0, 479)};
    scene.features.points.push_back(feature);
  }
  if (options.links) {
    if (model != nullptr) add_links(random, *model, image_of, options.missing_links, scene);
    add_clutter_links(random, scene.true_features, scene);
  }
  if (options.directions) add_directions(random, model, image_of, scene);
  if (options.edges) add_edges(random, model, scene);
  return scene;
}

}  // namespace landmarkdb::testing
