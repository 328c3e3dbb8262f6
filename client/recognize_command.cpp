#include <memory>
#include <string>
#include <vector>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "cli/write_file.hpp"
#include "client/program.hpp"
#include "client/read_points.hpp"
#include "client/render_recognition.hpp"
#include "client/session.hpp"
#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb::client {
namespace {

constexpr std::uint32_t kMostHypotheses = 100;
constexpr std::uint64_t kMaxImageBytes = std::uint64_t{256} << 20U;

// `recognize` as it is typed.
struct RecognizeArguments {
  std::string image;
  std::string points;
  std::string camera;
  std::vector<std::string> models;
  std::uint32_t top = 3;
  double min_confidence = 0.5;
  std::string min_depth;
  std::string max_depth;
  std::uint64_t seed = 1;
  std::string overlay;
};

const std::vector<cli::Example> kExamples = {
    {"landmarkdb recognize image.png --camera cam.json", "which model is this, and where"},
    {"landmarkdb recognize image.png --camera cam.json --model box --overlay seen.png",
     "one model only, and a picture of the answer"},
    {"landmarkdb recognize --points corners.json --camera cam.json --json",
     "the same from feature points that were found elsewhere"},
};

RecognizeInput load_input(const RecognizeArguments& a) {
  if (a.image.empty() == a.points.empty()) {
    throw cli::UsageError("IMAGE", "want an image, or --points with a file, and not both");
  }
  RecognizeInput input;
  input.camera = read_camera(a.camera);
  if (a.image.empty()) {
    if (!a.overlay.empty()) {
      throw cli::UsageError("--overlay", "is drawn on an image, but there are only --points");
    }
    read_points(a.points, input);
    return input;
  }
  const FileBytes file = read_whole_file(a.image, kMaxImageBytes);
  if (file.size == 0) {
    throw Error(ErrorCode::kInvalidArgument, a.image + ": is empty, want a PNG, JPEG or PGM image");
  }
  input.image.assign(reinterpret_cast<const char*>(file.data.get()), file.size);
  input.want_overlay = !a.overlay.empty();
  return input;
}

RecognizeOptions options_of(const RecognizeArguments& a) {
  RecognizeOptions options;
  options.models = a.models;
  options.top = a.top;
  options.min_confidence = a.min_confidence;
  if (!a.min_depth.empty()) options.min_depth_m = cli::parse_positive(a.min_depth, "--min-depth");
  if (!a.max_depth.empty()) options.max_depth_m = cli::parse_positive(a.max_depth, "--max-depth");
  if (options.min_depth_m >= options.max_depth_m) {
    throw cli::UsageError("--max-depth", "want more than --min-depth");
  }
  options.seed = a.seed;
  return options;
}

int run_recognize(const RecognizeArguments& arguments, const Program& program) {
  const RecognizeOptions options = options_of(arguments);
  const RecognizeInput input = load_input(arguments);
  Session session(program.options);
  const RecognizeAnswer answer = session.connect().recognize(input, options, session.context());
  session.finish();
  if (!arguments.overlay.empty()) {
    cli::write_file(arguments.overlay, answer.overlay_png, "--overlay");
  }
  program.print(recognition_json(answer.result), recognition_text(answer.result));
  return recognize_exit_status(answer.result);
}

}  // namespace

void add_recognize_command(CLI::App& app, Program& program) {
  const auto a = std::make_shared<RecognizeArguments>();
  CLI::App* command =
      cli::add_command(app,
                       "recognize",
                       "Find which model an image shows, and its pose before the camera",
                       kExamples);
  command->add_option("IMAGE", a->image, "Image: PNG, JPEG or PGM");
  command->add_option("--points", a->points, "Feature points (JSON) in place of an image")
      ->type_name("FILE");
  command->add_option("--camera", a->camera, "Camera file (YAML or JSON) of the image's size")
      ->type_name("FILE")
      ->required();
  cli::add_repeated(*command, "--model", a->models, "Look for this model only; may be repeated")
      ->type_name("NAME");
  command->add_option("--top", a->top, "At most so many hypotheses")
      ->type_name("K")
      ->check(CLI::Range(std::uint32_t{1}, kMostHypotheses))
      ->capture_default_str();
  command->add_option("--min-confidence", a->min_confidence, "Below this nothing is recognized")
      ->type_name("C")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--min-depth", a->min_depth, "Nearest the object may be, in metres [0.05]")
      ->type_name("M");
  command->add_option("--max-depth", a->max_depth, "Furthest the object may be, in metres [20]")
      ->type_name("M");
  command->add_option("--seed", a->seed, "Same image and seed: same answer")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--overlay", a->overlay, "Write the image with the answer drawn on it (PNG)")
      ->type_name("FILE");
  command->callback(
      [a, &program] { program.action = [a, &program] { return run_recognize(*a, program); }; });
}

}  // namespace landmarkdb::client
