#include "datasets/objects/object_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/parallel.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {

namespace {

// What differs between a table top and a floor.
struct Setting {
  double top_m;                    // height of the surface
  double reach_m;                  // things stand this far from the middle at most
  double nearest_m, farthest_m;    // of the camera from the middle
  double lowest_rad, highest_rad;  // its elevation
};
constexpr Setting kTable = {0.74, 0.5, 0.75, 1.5, 0.30, 1.0};
constexpr Setting kFloor = {0.0, 2.2, 2.2, 4.2, 0.12, 0.6};

// The upright or lying thing, its lowest point on the ground, its bounding disc around the origin.
struct Laid {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  double radius_m = 0.0;
};

Laid lay(const ObjectModel& model, bool lying, Random& random) {
  Eigen::Matrix3d R =
      Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Eigen::Vector3d::UnitZ())
          .matrix();
  if (lying) {
    const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
    R = R * Eigen::AngleAxisd(0.5 * std::numbers::pi,
                              Eigen::Vector3d(std::cos(around), std::sin(around), 0.0))
                .matrix();
  }
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : model.mesh.vertices) box.extend(R * p.cast<double>());
  Laid laid;
  laid.T.linear() = R;
  laid.T.translation() = Eigen::Vector3d(-box.center().x(), -box.center().y(), -box.min().z());
  laid.radius_m = 0.5 * box.diagonal().head<2>().norm();
  return laid;
}

void append(const TriangleMesh& part, const Eigen::Isometry3d& T, TriangleMesh& whole) {
  begin_object(whole, part.objects.empty() ? "thing" : part.objects.front().name);
  const auto first = static_cast<std::uint32_t>(whole.vertices.size());
  const auto object = static_cast<std::uint32_t>(whole.objects.size() - 1);
  for (const Eigen::Vector3f& p : part.vertices) whole.vertices.emplace_back(T.cast<float>() * p);
  for (const auto& corners : part.triangles) {
    whole.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    whole.object.push_back(object);
  }
}

void add_surroundings(const Setting& setting, Random& random, TriangleMesh& mesh) {
  constexpr double kRoom_m = 7.0;
  add_box(mesh, at(0, 0, -0.1), {kRoom_m, kRoom_m, 0.1});
  if (random.uniform() < 0.7) {  // a wall behind
    add_wall(mesh, at(-0.5 * kRoom_m, random.uniform(1.0, 3.0)), {kRoom_m, 2.8, 0.0, {}});
  }
  if (setting.top_m <= 0.0) return;
  const double width = random.uniform(1.1, 1.6);
  const double depth = random.uniform(0.7, 1.1);
  begin_object(mesh, "table");
  add_box(mesh, at(0, 0, setting.top_m - 0.04), {width, depth, 0.04});
  for (const double x : {-0.45, 0.45}) {
    for (const double y : {-0.45, 0.45}) {
      add_box(mesh, at(x * width, y * depth), {0.05, 0.05, setting.top_m - 0.04});
    }
  }
}

// Free of the discs taken, the nearer to the middle the more crowded.
std::optional<Eigen::Vector2d> find_room(const Setting& setting,
                                         std::span<const Eigen::Vector3d> taken,
                                         double radius_m,
                                         double crowding,
                                         Random& random) {
  constexpr int kTries = 400;
  // Bounding discs overlap before things do: half of what a crowd may share.
  const double share = 1.0 - 0.3 * crowding;
  for (int i = 0; i < kTries; ++i) {
    const double tried = static_cast<double>(i + 1) / kTries;
    const double reach = setting.reach_m * (tried + (1.0 - tried) * 0.6 * (1.0 - crowding));
    const double away = reach * std::sqrt(random.uniform());
    const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector2d spot(away * std::cos(around), away * std::sin(around));
    const bool free = std::all_of(taken.begin(), taken.end(), [&](const Eigen::Vector3d& disc) {
      return (disc.head<2>() - spot).norm() >= share * (disc.z() + radius_m);
    });
    if (free) return spot;
  }
  return std::nullopt;
}

Eigen::Isometry3d camera_pose(const Setting& setting, Random& random) {
  const double azimuth = random.uniform(-std::numbers::pi, 0.0);  // the wall stands behind
  const double elevation = random.uniform(setting.lowest_rad, setting.highest_rad);
  const double away = random.uniform(setting.nearest_m, setting.farthest_m);
  const double spread = 0.2 * setting.reach_m;
  const Eigen::Vector3d aim(random.uniform(-spread, spread),
                            random.uniform(-spread, spread),
                            setting.top_m + 0.2 * setting.reach_m);
  const Eigen::Vector3d eye = aim + away * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                           std::cos(elevation) * std::sin(azimuth),
                                                           std::sin(elevation));
  const Eigen::Vector3d z = (aim - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x, z.cross(x), z;
  T.linear() =
      T.linear() *
      Eigen::AngleAxisd(0.1 * random.normal(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = eye;
  return T;
}

// Which thing (index + 1) every second pixel of every second row shows; 0: none.
std::vector<std::size_t> shown(const RayCaster& caster,
                               std::span<const std::size_t> ends,
                               const Eigen::Isometry3d& T_scene_camera,
                               const Camera& camera,
                               const RunContext& context) {
  constexpr std::size_t kStep = 2;
  const std::size_t columns = camera.width / kStep;
  std::vector<std::size_t> what(columns * (camera.height / kStep), 0);
  const Eigen::Vector3f eye = T_scene_camera.translation().cast<float>();
  parallel_chunks(what.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d ray(
          (static_cast<double>(kStep * (i % columns)) - camera.cx) / camera.fx,
          (static_cast<double>(kStep * (i / columns)) - camera.cy) / camera.fy,
          1.0);
      const auto hit =
          caster.first_hit(eye, (T_scene_camera.linear() * ray.normalized()).cast<float>(), 20.0F);
      if (!hit) continue;
      const auto thing = std::upper_bound(ends.begin(), ends.end(), hit->triangle);
      if (thing != ends.end()) what[i] = static_cast<std::size_t>(thing - ends.begin()) + 1;
    }
  });
  return what;
}

void measure_visible(const std::vector<const ObjectModel*>& models,
                     std::span<const std::size_t> ends,
                     const Camera& camera,
                     const RunContext& context,
                     ObjectScene& scene) {
  constexpr std::size_t kPixelsEach = 4;
  const Eigen::Isometry3d& T = scene.frame.T_scene_camera;
  const auto all = shown(*scene.place.caster, ends, T, camera, context);
  for (std::size_t i = 0; i < scene.things.size(); ++i) {
    Standing& thing = scene.things[i];
    TriangleMesh alone;
    append(models[thing.model]->mesh, thing.T_scene_object, alone);
    const std::size_t whole[] = {alone.triangles.size()};
    const auto by_itself = shown(RayCaster(alone), whole, T, camera, context);
    const auto seen = std::count(all.begin(), all.end(), i + 1);
    const auto could = std::count(by_itself.begin(), by_itself.end(), std::size_t{1});
    thing.pixels = kPixelsEach * static_cast<std::size_t>(seen);
    thing.unhidden = could == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(could);
  }
}

DepthCameraOptions sensor_options(const ObjectSceneOptions& options) {
  DepthCameraOptions camera;
  camera.seed = options.seed;
  if (options.sensor == ObjectSensor::kScanner) {
    camera.noise_scale = 0.1;
    camera.quantise = false;
    camera.shadows = false;
    camera.edge_holes = 0.2;
    camera.min_range_m = 0.3;
  }
  return camera;
}

}  // namespace

ObjectScene make_object_scene(const std::vector<const ObjectModel*>& models,
                              const ObjectSceneOptions& options,
                              const RunContext& context) {
  const Setting& setting = options.ground == ObjectGround::kTable ? kTable : kFloor;
  Random random(options.seed);
  ObjectScene scene;
  scene.place.name = options.ground == ObjectGround::kTable ? "table" : "floor";
  TriangleMesh& mesh = scene.place.mesh;
  std::vector<Eigen::Vector3d> taken;  // x, y, radius
  std::vector<std::size_t> ends;       // behind the last triangle of each thing
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Laid laid = lay(*models[i], random.uniform() < options.lying, random);
    const auto spot = find_room(setting, taken, laid.radius_m, options.crowding, random);
    if (!spot) continue;
    taken.emplace_back(spot->x(), spot->y(), laid.radius_m);
    Standing thing;
    thing.model = i;
    thing.T_scene_object = Eigen::Translation3d(spot->x(), spot->y(), setting.top_m) * laid.T;
    append(models[i]->mesh, thing.T_scene_object, mesh);
    ends.push_back(mesh.triangles.size());
    scene.things.push_back(thing);
  }
  add_surroundings(setting, random, mesh);
  scene.place.caster = std::make_shared<RayCaster>(mesh);
  const DepthCameraOptions camera = sensor_options(options);
  scene.frame = render_depth(scene.place, camera_pose(setting, random), camera, context);
  measure_visible(models, ends, camera.camera, context, scene);
  return scene;
}

}  // namespace landmarkdb::datasets
