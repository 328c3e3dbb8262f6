#include <memory>
#include <string>
#include <string_view>
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
#include "client/recognize_options.hpp"
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
  RecognizeLimits limits;
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
  apply(a.limits, options);
  return options;
}

// What the server says of "image" is said of the file.
RecognizeAnswer ask(Session& session,
                    const RecognizeInput& input,
                    const RecognizeOptions& options,
                    const std::string& path) {
  constexpr std::string_view kPrefix = "image: ";
  try {
    return session.connect().recognize(input, options, session.context());
  } catch (const Error& error) {
    const std::string what = error.what();
    if (error.field() != "image" || !what.starts_with(kPrefix)) throw;
    throw Error(error.code(), path + ": " + what.substr(kPrefix.size()), error.field());
  }
}

int run_recognize(const RecognizeArguments& arguments, const Program& program) {
  const RecognizeOptions options = options_of(arguments);
  const RecognizeInput input = load_input(arguments);
  Session session(program.options);
  const RecognizeAnswer answer = ask(session, input, options, arguments.image);
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
  add_recognize_limits(*command, a->limits);
  command->add_option("--overlay", a->overlay, "Write the image with the answer drawn on it (PNG)")
      ->type_name("FILE");
  command->callback(
      [a, &program] { program.action = [a, &program] { return run_recognize(*a, program); }; });
}

}  // namespace landmarkdb::client
