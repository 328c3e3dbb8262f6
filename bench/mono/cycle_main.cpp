// landmarkdb-bench-mono-cycle: the time from an image to joint rates, on rendered images of a model
// that an arm moves past, with the model recognised anew in each image and with it tracked.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/main_guard.hpp"
#include "datasets/mono/render_model.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/mono/tracker.hpp"
#include "engine/servo/servo.hpp"
#include "tests/support/make_mono_scene.hpp"
#include "tests/support/servo_arms.hpp"

namespace {

using namespace landmarkdb;

// One image of the run, and what is true in it.
struct Shot {
  JointVector q;
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
  GreyImage image;
};

// The arm wanders about its goal, some 5 px a cycle.
std::vector<Shot> take_shots(const MonoModel& model,
                             const ServoOptions& servo,
                             int count,
                             int clutter) {
  const JointVector home = testing::puma_560_pose();
  const Eigen::Isometry3d T_base_object = camera_pose(servo.arm, home) * servo.T_camera_object;
  std::vector<Shot> shots;
  for (int k = 0; k < count; ++k) {
    const double phase = 2.0 * std::numbers::pi * k / 60.0;
    Shot shot;
    shot.q = home;
    for (Eigen::Index i = 0; i < 6; ++i) {
      shot.q(i) +=
          0.05 * std::sin(phase * (1.0 + 0.1 * static_cast<double>(i)) + static_cast<double>(i));
    }
    shot.T_camera_object = camera_pose(servo.arm, shot.q).inverse() * T_base_object;
    shot.image = datasets::render_model(model,
                                        testing::arm_camera(),
                                        shot.T_camera_object,
                                        {.noise = 2.0, .clutter = clutter, .samples = 3});
    shots.push_back(std::move(shot));
  }
  return shots;
}

// Of the clock, or of this thread's work: a cycle runs on one.
double time_ms(bool cpu) {
  timespec now{};
  clock_gettime(cpu ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Row {
  std::vector<double> ms;
  int measured = 0;
  int right = 0;  // within 10 mm and 3 degrees
};

Row run_cycles(const std::vector<Shot>& shots,
               const ServoOptions& options,
               bool cpu_time,
               const std::function<std::optional<Eigen::Isometry3d>(const GreyImage&)>& see) {
  Servo servo(options);
  Row row;
  for (const Shot& shot : shots) {
    const double begin_ms = time_ms(cpu_time);
    const std::optional<Eigen::Isometry3d> seen = see(shot.image);
    const ServoCommand command = servo.step({.q = shot.q, .T_camera_object = seen});
    row.ms.push_back(time_ms(cpu_time) - begin_ms);
    if (!seen || !command.joint_rates.allFinite()) continue;
    ++row.measured;
    const Eigen::Isometry3d off = seen->inverse() * shot.T_camera_object;
    constexpr double kRight_m = 0.010;
    constexpr double kRight_rad = 3.0 * std::numbers::pi / 180.0;
    const double shift_m = (seen->translation() - shot.T_camera_object.translation()).norm();
    if (shift_m < kRight_m && rotation_angle_rad(off.linear()) < kRight_rad) ++row.right;
  }
  return row;
}

void print_row(const char* name, Row row) {
  std::sort(row.ms.begin(), row.ms.end());
  const auto at = [&](double share) {
    return row.ms[static_cast<std::size_t>(share * static_cast<double>(row.ms.size() - 1))];
  };
  std::printf("%-34s %7zu %8d %6d %9.2f %7.2f %7.2f\n",
              name,
              row.ms.size(),
              row.measured,
              row.right,
              at(0.5),
              at(0.95),
              at(1.0));
}

void run(int images, std::size_t models, int clutter, bool cpu_time) {
  const auto catalog = testing::make_mono_catalog({.seed = 10000, .types = 1}, models);
  const auto record = catalog->entries.front().record;
  const Recognizer recognizer(catalog);
  const Camera camera = testing::arm_camera();
  ServoOptions servo;
  servo.arm = testing::puma_560(3.0);
  servo.T_camera_object.translation() = Eigen::Vector3d(0.0, 0.0, 0.6);
  servo.T_camera_object.linear() = rotation_from_vector({0.9, 0.5, 0.2});
  const std::vector<Shot> shots = take_shots(record->model, servo, images, clutter);
  std::printf("%-34s %7s %8s %6s %9s %7s %7s\n",
              "image to joint rates",
              "images",
              "measured",
              "right",
              "median ms",
              "p95",
              "worst");
  RecognizeOptions among_all;
  RecognizeOptions one = among_all;
  one.models = {record->model.name};
  const auto anew = [&](const RecognizeOptions& options, const GreyImage& image) {
    const RecognizeResult answer = recognizer.recognize(image, camera, options, {});
    std::optional<Eigen::Isometry3d> T;
    if (answer.status == RecognizeStatus::kRecognized && !answer.hypotheses.empty() &&
        answer.hypotheses.front().model == record->model.name) {
      T = answer.hypotheses.front().T_camera_object;
    }
    return T;
  };
  print_row("recognised anew, among all models",
            run_cycles(shots, servo, cpu_time, [&](const GreyImage& image) {
              return anew(among_all, image);
            }));
  print_row(
      "recognised anew, one model named",
      run_cycles(shots, servo, cpu_time, [&](const GreyImage& image) { return anew(one, image); }));
  Tracker tracker(record, camera, {}, &recognizer);
  print_row("tracked, the first recognised",
            run_cycles(shots, servo, cpu_time, [&](const GreyImage& image) {
              const TrackResult seen = tracker.next(image, {});
              return seen.measured() ? seen.T_camera_object : std::nullopt;
            }));
}

}  // namespace

int main(int argc, char** argv) {
  int images = 120;
  std::size_t models = 100;
  int clutter = 10;
  bool cpu_time = false;
  CLI::App app{"Time from an image to joint rates, on rendered images of 640 x 480."};
  app.add_option("--images", images, "images of the run")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  app.add_option("--models", models, "models in the catalogue")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--clutter", clutter, "shapes behind the model")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  app.add_flag("--cpu-time", cpu_time, "times are the thread's, not the clock's");
  return cli::run_main(argc, argv, app, [&] {
    run(images, models, clutter, cpu_time);
    return 0;
  });
}
