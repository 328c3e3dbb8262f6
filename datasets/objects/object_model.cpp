#include "datasets/objects/object_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "datasets/furniture/furniture.hpp"
#include "datasets/objects/object_shapes.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::datasets {

namespace {

constexpr std::array kTable = {ObjectKind::kFigurine,
                               ObjectKind::kMilkCarton,
                               ObjectKind::kAnimal,
                               ObjectKind::kMug,
                               ObjectKind::kTrain,
                               ObjectKind::kCarton,
                               ObjectKind::kSprayBottle,
                               ObjectKind::kTool,
                               ObjectKind::kBottle};
constexpr std::array kFloor = {ObjectKind::kChair,
                               ObjectKind::kStatue,
                               ObjectKind::kVending,
                               ObjectKind::kPlant,
                               ObjectKind::kBin};

void build(const ObjectOptions& options, ObjectModel& model) {
  Random random(options.seed);
  const Workshop shop{model.mesh, random};
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  switch (options.kind) {
    case ObjectKind::kFigurine:
      add_figurine(shop);
      break;
    case ObjectKind::kAnimal:
      add_animal(shop);
      break;
    case ObjectKind::kCarton:
      add_carton(shop);
      break;
    case ObjectKind::kMilkCarton:
      add_milk_carton(shop);
      break;
    case ObjectKind::kBottle:
      add_bottle(shop);
      break;
    case ObjectKind::kSprayBottle:
      add_spray_bottle(shop);
      break;
    case ObjectKind::kMug:
      add_mug(shop);
      break;
    case ObjectKind::kTool:
      add_tool(shop);
      break;
    case ObjectKind::kTrain:
      add_train(shop);
      break;
    case ObjectKind::kChair:
      add_office_chair(shop, T);
      break;
    case ObjectKind::kPlant:
      add_plant(shop, T);
      break;
    case ObjectKind::kStatue:
      add_statue(shop, T, random.uniform(0.9, 1.7));
      break;
    case ObjectKind::kBin:
      add_bin(shop, T);
      break;
    case ObjectKind::kVending:
      add_vending_machine(shop, T);
      break;
  }
}

// A look-alike's measures; what is turned on a lathe stays round.
Eigen::Vector3f stretch_of(const ObjectOptions& options, bool round) {
  constexpr double kLeast = 0.08, kMost = 0.25;
  if (options.twin == 0) return Eigen::Vector3f::Ones();
  Random random(options.seed * 1000 + options.twin);
  Eigen::Vector3d stretch;
  for (int i = 0; i < 3; ++i) {
    const double by = random.uniform(kLeast, kMost);
    stretch[i] = random.uniform() < 0.5 ? 1.0 + by : 1.0 / (1.0 + by);
  }
  if (round) stretch.y() = stretch.x();
  return stretch.cast<float>();
}

Eigen::Isometry3d half_turn(const Eigen::Vector3d& axis, const Eigen::Vector3d& through) {
  return Eigen::Translation3d(through) * Eigen::AngleAxisd(std::numbers::pi, axis) *
         Eigen::Translation3d(-through);
}

}  // namespace

std::span<const ObjectKind> table_objects() { return kTable; }
std::span<const ObjectKind> floor_objects() { return kFloor; }

std::string_view object_kind_name(ObjectKind kind) {
  constexpr std::array<std::string_view, 14> kNames = {"figurine",
                                                       "animal",
                                                       "carton",
                                                       "milk-carton",
                                                       "bottle",
                                                       "spray-bottle",
                                                       "mug",
                                                       "tool",
                                                       "train",
                                                       "chair",
                                                       "plant",
                                                       "statue",
                                                       "bin",
                                                       "vending"};
  return kNames.at(static_cast<std::size_t>(kind));
}

ObjectModel make_object(const ObjectOptions& options) {
  ObjectModel model;
  model.options = options;
  model.name = std::string(object_kind_name(options.kind)) + "-" + std::to_string(options.seed) +
               (options.twin == 0 ? "" : "-twin-" + std::to_string(options.twin));
  build(options, model);
  model.revolution = options.kind == ObjectKind::kBottle;
  const Eigen::Vector3f stretch = stretch_of(options, model.revolution);
  Eigen::AlignedBox3f box;
  for (Eigen::Vector3f& p : model.mesh.vertices) box.extend(p = p.cwiseProduct(stretch));
  const Eigen::Vector3f foot(box.center().x(), box.center().y(), box.min().z());
  for (Eigen::Vector3f& p : model.mesh.vertices) p -= foot;
  model.centre = (box.center() - foot).cast<double>();
  model.extent_m = static_cast<double>(box.diagonal().norm());
  if (options.kind == ObjectKind::kCarton) {
    for (int i = 0; i < 3; ++i) {
      model.symmetries.push_back(half_turn(Eigen::Vector3d::Unit(i), model.centre));
    }
  }
  return model;
}

ObjectError object_error(const ObjectModel& model,
                         const Eigen::Isometry3d& T_scene_object,
                         const Eigen::Isometry3d& estimate) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto from = [&](const Eigen::Isometry3d& truth) {
    const double metres = (truth * model.centre - estimate * model.centre).norm();
    const double turn =
        model.revolution
            ? std::acos(std::clamp(truth.linear().col(2).dot(estimate.linear().col(2)), -1.0, 1.0))
            : rotation_angle_rad(truth.linear().transpose() * estimate.linear());
    return std::pair(metres, kDegrees * turn);
  };
  ObjectError error;
  std::tie(error.metres, error.degrees) = from(T_scene_object);
  error.symmetric_metres = error.metres;
  error.symmetric_degrees = error.degrees;
  for (const Eigen::Isometry3d& symmetry : model.symmetries) {
    const auto [metres, degrees] = from(T_scene_object * symmetry);
    if (degrees >= error.symmetric_degrees) continue;
    error.symmetric_metres = metres;
    error.symmetric_degrees = degrees;
  }
  return error;
}

}  // namespace landmarkdb::datasets
