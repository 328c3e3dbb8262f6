#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "client/frame_source.hpp"
#include "client/program.hpp"
#include "client/recognize_options.hpp"
#include "client/render_track.hpp"
#include "client/session.hpp"
#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb::client {
namespace {

constexpr std::uint64_t kMaxArmBytes = std::uint64_t{256} * 1024;  // as the server
constexpr int kNothingSeen = 3;

// `track` as it is typed.
struct TrackArguments {
  std::string source;
  std::string camera;
  std::string model;
  std::string servo;
  std::string start;
  RecognizeLimits limits;
};

const std::vector<cli::Example> kExamples = {
    {"landmarkdb track video/ --camera cam.json --model box",
     "the images of a folder in the order of their names: a line of JSON each"},
    {"landmarkdb track 'video/left-*.png' --camera cam.json --model box --servo arm.json",
     "with the joint rates that bring the arm to where it should see the box"},
    {"tracker | landmarkdb track - --camera cam.json --model box --servo arm.json | robot",
     "frames as they come: a line {\"image\": FILE, \"q\": [...]} or {\"points\": [...]} each"},
};

std::string read_arm(const std::string& path) {
  if (path.empty()) return {};
  const FileBytes file = read_whole_file(path, kMaxArmBytes);
  if (file.size == 0) {
    throw Error(ErrorCode::kInvalidArgument, path + ": is empty, want an arm file");
  }
  return {reinterpret_cast<const char*>(file.data.get()), file.size};
}

TrackSetup setup_of(const TrackArguments& a) {
  TrackSetup setup;
  RecognizeOptions& options = setup.recognize;
  apply(a.limits, options);
  if (!a.start.empty()) setup.start = cli::read_pose(a.start);
  setup.camera = read_camera(a.camera);
  setup.model = a.model;
  setup.servo = read_arm(a.servo);
  return setup;
}

// Follows the frames and keeps count of what became of them.
class Run {
 public:
  Run(const TrackArguments& arguments, const Program& program)
      : arguments_(arguments), program_(program), session_(program.options) {}

  int operator()() {
    const TrackSetup setup = setup_of(arguments_);
    const std::unique_ptr<FrameSource> frames =
        open_frames(arguments_.source, session_.context().stop);
    Client& client = session_.connect();
    const std::uint32_t track = open(client, setup);
    while (frames->advance()) {
      const nlohmann::ordered_json line = next(client, track, *frames);
      std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
      show_progress(*frames);
    }
    session_.finish();
    client.close_track(track, limits());
    if (seen_ > 0) return 0;
    if (!first_problem_.empty()) throw Error(ErrorCode::kInvalidArgument, first_problem_);
    return kNothingSeen;
  }

 private:
  // The time limit is for each request: a track may last as long as its source.
  RunContext limits() const {
    RunContext context;
    context.stop = session_.context().stop;
    context.deadline = std::chrono::steady_clock::now() +
                       std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                           std::chrono::duration<double>(program_.options.timeout_s));
    return context;
  }

  std::uint32_t open(Client& client, const TrackSetup& setup) const {
    try {
      return client.open_track(setup, limits());
    } catch (const Error& error) {
      if (error.field() != "servo") throw;
      throw Error(error.code(), arguments_.servo + ": " + error.what(), "--servo");
    }
  }

  // A frame that cannot be used is told, and the next one tried.
  nlohmann::ordered_json next(Client& client, std::uint32_t track, FrameSource& frames) {
    ++frames_;
    try {
      const TrackInput input = frames.load();
      const TrackedFrame answer = client.track(track, input, limits());
      if (answer.seen()) ++seen_;
      return track_json(frames.name(), answer);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kInvalidArgument) throw;
      const std::string what = error.what();
      if (first_problem_.empty()) {
        first_problem_ = what.starts_with(frames.name()) ? what : frames.name() + ": " + what;
      }
      return unusable_frame_json(frames.name(), error.what());
    }
  }

  // Not between the lines on one terminal.
  void show_progress(const FrameSource& frames) const {
    const auto& progress = session_.context().progress;
    if (progress && ::isatty(STDOUT_FILENO) == 0) progress({"frames", frames_, frames.total()});
  }

  const TrackArguments& arguments_;
  const Program& program_;
  Session session_;
  std::uint64_t frames_ = 0;
  std::uint64_t seen_ = 0;
  std::string first_problem_;
};

}  // namespace

void add_track_command(CLI::App& app, Program& program) {
  const auto a = std::make_shared<TrackArguments>();
  CLI::App* command = cli::add_command(
      app,
      "track",
      "Follow a model from image to image: one line of JSON a frame, and joint rates for an arm",
      kExamples);
  command
      ->add_option("SOURCE",
                   a->source,
                   "Folder or quoted pattern of images, one image, a JSON-lines file, or - for "
                   "JSON lines on standard input")
      ->required();
  command->add_option("--camera", a->camera, "Camera file (YAML or JSON) of the images' size")
      ->type_name("FILE")
      ->required();
  command->add_option("--model", a->model, "The model to follow")->type_name("NAME")->required();
  command->add_option("--servo", a->servo, "Arm file (JSON): answer with joint rates too")
      ->type_name("FILE");
  command
      ->add_option(
          "--start", a->start, "T_camera_object before the first frame, file or 16 numbers")
      ->type_name("T16");
  add_recognize_limits(*command, a->limits);
  command->callback(
      [a, &program] { program.action = [a, &program] { return Run(*a, program)(); }; });
}

}  // namespace landmarkdb::client
