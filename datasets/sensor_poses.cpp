#include "datasets/sensor_poses.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "datasets/ray_noise.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr int kFan = 48;           // rays that must be clear around a free point
constexpr int kMaxTries = 20'000;  // draws for one pose before giving up
constexpr float kFar_m = 100.0F;   // larger than any building made here
constexpr double kViewNearest_m = 0.5, kViewFurthest_m = 8.0;

// Directions spread evenly over the sphere (golden spiral).
Eigen::Vector3f fan_direction(int i) {
  const double z = 1.0 - (2.0 * i + 1.0) / kFan;
  const double r = std::sqrt(1.0 - z * z);
  const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
  return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
}

// Share of a coarse image in which the camera sees a surface within its range.
double valid_share(const RayCaster& caster, const Eigen::Isometry3d& T_scene_camera) {
  constexpr int kColumns = 12, kRows = 9;
  constexpr double kHalfWidth = 0.61, kHalfHeight = 0.457;  // tangents, of 640 x 480 at f 525
  int valid = 0;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const double x = kHalfWidth * (2.0 * (i % kColumns + 0.5) / kColumns - 1.0);
    const double y = kHalfHeight * (2.0 * (i / kColumns + 0.5) / kRows - 1.0);
    const Eigen::Vector3d ray = T_scene_camera.linear() * Eigen::Vector3d(x, y, 1.0).normalized();
    const auto hit = caster.first_hit(
        T_scene_camera.translation().cast<float>(), ray.cast<float>(), kViewFurthest_m);
    if (hit && hit->returns_light && hit->distance_m > kViewNearest_m) ++valid;
  }
  return static_cast<double>(valid) / (kColumns * kRows);
}

// Columns: the camera's right, down and forward in the scene.
Eigen::Matrix3d look(double yaw, double pitch, double roll) {
  const Eigen::Vector3d forward(
      std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  const Eigen::Vector3d right(std::sin(yaw), -std::cos(yaw), 0.0);
  Eigen::Matrix3d R;
  R << right, forward.cross(right), forward;
  return R * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

std::vector<const StandingArea*> areas_of(const Place& place, int floor) {
  std::vector<const StandingArea*> areas;
  for (const StandingArea& area : place.areas) {
    if (floor < 0 || area.floor == floor) areas.push_back(&area);
  }
  if (areas.empty()) {
    throw Error(ErrorCode::kInvalidArgument,
                place.name + ": nowhere to stand" +
                    (floor < 0 ? std::string() : " on floor " + std::to_string(floor)));
  }
  return areas;
}

// A point at eye height; areas are drawn by their size.
Eigen::Vector3d draw_position(const std::vector<const StandingArea*>& areas,
                              const PoseSampling& sampling,
                              Random& random) {
  double total = 0.0;
  for (const StandingArea* area : areas) total += area->size_m.prod();
  double at = total * random.uniform();
  const StandingArea* chosen = areas.back();
  for (const StandingArea* area : areas) {
    at -= area->size_m.prod();
    if (at < 0.0) {
      chosen = area;
      break;
    }
  }
  return chosen->T_scene_area *
         Eigen::Vector3d(random.uniform(0.0, chosen->size_m.x()),
                         random.uniform(0.0, chosen->size_m.y()),
                         random.uniform(sampling.lowest_eye_m, sampling.highest_eye_m));
}

template <typename Draw>
std::vector<Eigen::Isometry3d> sample(const Place& place,
                                      std::size_t count,
                                      std::uint64_t seed,
                                      const PoseSampling& sampling,
                                      const Draw& draw) {
  const std::vector<const StandingArea*> areas = areas_of(place, sampling.floor);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < count; ++i) {
    Random random = ray_random(seed, i);
    int tries = 0;
    for (; tries < kMaxTries; ++tries) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.translation() = draw_position(areas, sampling, random);
      if (!is_free(*place.caster, T.translation(), sampling.clearance_m)) continue;
      if (draw(T, random)) {
        poses.push_back(T);
        break;
      }
    }
    if (tries == kMaxTries) {
      throw Error(ErrorCode::kInvalidArgument,
                  place.name + ": no free place with " + std::to_string(sampling.clearance_m) +
                      " m around found in " + std::to_string(kMaxTries) + " draws");
    }
  }
  return poses;
}

}  // namespace

bool is_free(const RayCaster& caster, const Eigen::Vector3d& p_scene, double clearance_m) {
  for (int i = 0; i < kFan; ++i) {
    const auto hit = caster.first_hit(p_scene.cast<float>(), fan_direction(i), kFar_m);
    if (!hit || !hit->front_face || hit->distance_m < clearance_m) return false;
  }
  return true;
}

std::vector<Eigen::Isometry3d> sample_camera_poses(const Place& place,
                                                   std::size_t count,
                                                   std::uint64_t seed,
                                                   const PoseSampling& sampling) {
  return sample(
      place, count, seed, sampling, [&](Eigen::Isometry3d& T_scene_camera, Random& random) {
        const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
        const double pitch = random.uniform(sampling.lowest_pitch_rad, sampling.highest_pitch_rad);
        const double roll = sampling.any_roll ? random.uniform(-std::numbers::pi, std::numbers::pi)
                                              : sampling.roll_rad * random.normal();
        T_scene_camera.linear() = look(yaw, pitch, roll);
        return valid_share(*place.caster, T_scene_camera) >= sampling.min_valid;
      });
}

std::vector<Eigen::Isometry3d> sample_upright_poses(const Place& place,
                                                    std::size_t count,
                                                    std::uint64_t seed,
                                                    const PoseSampling& sampling) {
  return sample(
      place, count, seed, sampling, [](Eigen::Isometry3d& T_scene_sensor, Random& random) {
        const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
        T_scene_sensor.linear() =
            Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        return true;
      });
}

}  // namespace landmarkdb::datasets
