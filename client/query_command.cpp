#include "client/query_command.hpp"

#include <memory>
#include <utility>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "cli/write_file.hpp"
#include "client/choices.hpp"
#include "client/correspondences_csv.hpp"
#include "client/load_cloud.hpp"
#include "client/render_json.hpp"
#include "client/render_text.hpp"
#include "client/report/report.hpp"
#include "client/session.hpp"
#include "engine/cloud/join_clouds.hpp"

namespace landmarkdb::client {
namespace {

// Of the scene, for a report: the page has 400 kB of them and is drawn in a blink.
constexpr std::uint32_t kReportPoints = 40'000;

const std::vector<cli::Example> kExamples = {
    {"landmarkdb query view.ply", "which stored place is this, and where in it was the sensor"},
    {"landmarkdb query --camera kinect.yaml depth.png --json | jq .hypotheses[0].translation_m",
     "the same for a depth image, for scripts"},
    {"landmarkdb query scan.pcd --scene lobby --up 0,0,1 --correspondences pairs.csv",
     "one scene only, gravity known, every pair written down"},
    {"landmarkdb query a.ply b.ply --pose a.txt --pose b.txt",
     "two views whose poses to each other are known, as one"},
    {"landmarkdb query view.ply --report where.html", "a page that shows the cloud in the place"},
    {"landmarkdb query view.ply --explain", "which step lost it, and what would have helped"},
};

void add_input_options(CLI::App& app, QueryArguments& a) {
  app.add_option("CLOUD",
                 a.clouds,
                 "Point cloud, mesh, or with --camera a depth image; several are laid together")
      ->required()
      ->expected(1, static_cast<int>(kMostQueryClouds));
  cli::add_repeated(app,
                    "--pose",
                    a.poses,
                    "Pose of a cloud in the frame they share (the answer's sensor frame), one for "
                    "each cloud, 16 numbers by rows [identity]")
      ->type_name("FILE");
  app.add_option("--camera", a.camera, "Camera file (YAML or JSON): CLOUD is a depth image")
      ->type_name("FILE");
  app.add_option("--units", a.units, "Unit of the cloud's coordinates")
      ->check(CLI::IsMember(kUnitNames))
      ->capture_default_str();
  cli::add_repeated(app,
                    "--viewpoint",
                    a.viewpoints,
                    "Where the sensor stood, in the cloud's frame and units, one for each cloud "
                    "[the file's, else 0,0,0]")
      ->type_name("x,y,z");
}

void add_answer_options(CLI::App& app, QueryArguments& a) {
  cli::add_repeated(app, "--scene", a.scenes, "Look in this scene only; may be repeated")
      ->type_name("NAME");
  app.add_option("--top", a.top, "At most so many hypotheses")
      ->type_name("K")
      ->check(CLI::Range(std::uint32_t{1}, kMostHypotheses))
      ->capture_default_str();
  app.add_option("--min-confidence", a.min_confidence, "Below this nothing counts as localized")
      ->type_name("C")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--up", a.up, "Direction against gravity in the cloud's frame")
      ->type_name("x,y,z");
  app.add_option("--prior",
                 a.prior,
                 "Where the sensor is thought to be: T_scene_sensor, a file or 16 numbers by rows")
      ->type_name("T16");
  app.add_option("--prior-radius", a.prior_radius, "How far from the prior it may be, in metres")
      ->type_name("M");
  app.add_option("--correspondences", a.correspondences, "Write every putative pair as CSV")
      ->type_name("FILE");
  app.add_option("--report", a.report, "Write a page that shows the answer: one HTML file")
      ->type_name("FILE");
  app.add_flag("--explain",
               a.explain,
               "Say what each step left, what spoke for and against each candidate, and what would "
               "have changed the answer");
}

void add_method_options(CLI::App& app, QueryArguments& a) {
  app.add_option("--profile", a.profile, "The robust method, or the one of the paper")
      ->check(CLI::IsMember(kProfileNames))
      ->capture_default_str();
  app.add_option("--keypoints", a.keypoints, "Keypoint detector [as the profile says]")
      ->check(CLI::IsMember(kKeypointNames));
  app.add_option("--measure", a.measure, "How descriptors are compared")
      ->check(CLI::IsMember(kMeasureNames))
      ->capture_default_str();
  app.add_option("--ratio", a.ratio, "Threshold of the ratio filter")
      ->type_name("R")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--filters", a.filters, "Filters of the pairs [as the profile says]")
      ->type_name("ratio,slope,clique");
  app.add_option("--search", a.search, "Search for neighbours: exact, or FLANN's approximate one")
      ->check(CLI::IsMember(kSearchNames))
      ->capture_default_str();
  app.add_option("--solver", a.solver, "Pose from the pairs' positions, or from directions alone")
      ->check(CLI::IsMember(kSolverNames))
      ->capture_default_str();
  app.add_flag("--scale", a.scale, "Estimate the scale too [1]");
  app.add_option("--seed", a.seed, "Same cloud and seed: same answer")
      ->type_name("N")
      ->check(cli::not_negative)
      ->capture_default_str();
}

void set_prior(const QueryArguments& a, QueryOptions& options) {
  if (a.prior.empty() != a.prior_radius.empty()) {
    throw cli::UsageError(a.prior.empty() ? "--prior" : "--prior-radius",
                          "--prior and --prior-radius go together");
  }
  if (a.prior.empty()) return;
  options.prior_radius_m = cli::parse_positive(a.prior_radius, "--prior-radius");
  options.prior_T_scene_sensor = cli::read_pose(a.prior);
}

// What a report calls the clouds.
std::string title_of(const QueryArguments& a) {
  std::string title = a.clouds.front();
  if (a.clouds.size() > 1) title += " and " + std::to_string(a.clouds.size() - 1) + " more";
  return title;
}

// The clouds as the server lays them together, for drawing. One alone is drawn as it was sent.
PointCloud in_one(std::vector<QueryCloud> clouds) {
  if (clouds.size() == 1 && clouds[0].T_query_cloud.matrix().isIdentity(0.0)) {
    return std::move(clouds[0].cloud);
  }
  CloudCounts counts;
  return join_clouds(std::move(clouds), counts);
}

}  // namespace

void add_query_command(CLI::App& app, Program& program) {
  const auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command = cli::add_command(
      app, "query", "Find where a cloud was taken: the scene and the sensor's pose", kExamples);
  add_input_options(*command, *arguments);
  add_answer_options(*command, *arguments);
  add_method_options(*command, *arguments);
  command->callback([arguments, &program] {
    program.action = [arguments, &program] { return run_query(*arguments, program); };
  });
}

QueryOptions query_options(const QueryArguments& a) {
  QueryOptions options;
  options.profile = a.profile == "paper" ? Profile::kPaper : Profile::kRobust;
  options.scenes = a.scenes;
  options.top = a.top;
  options.min_confidence = a.min_confidence;
  if (!a.up.empty()) options.up = cli::parse_direction(a.up, "--up");
  set_prior(a, options);
  if (!a.keypoints.empty()) options.keypoints = keypoint_method(a.keypoints, "--keypoints");
  options.measure = measure(a.measure, "--measure");
  options.search = a.search == "flann" ? Search::kFlann : Search::kExact;
  options.ratio = a.ratio;
  if (!a.filters.empty()) options.filters = filters(a.filters, "--filters");
  options.solver = a.solver == "pnp" ? Solver::kPnp : Solver::kSimilarity;
  options.estimate_scale = a.scale;
  options.seed = a.seed;
  const bool report = !a.report.empty();
  options.want_correspondences = report || !a.correspondences.empty();
  options.explain = report || a.explain;
  if (report) options.want_scene_points = kReportPoints;
  return options;
}

std::vector<QueryCloud> load_query(const QueryArguments& a) {
  check_one_each("--pose", a.poses.size(), a.clouds.size());
  check_one_each("--viewpoint", a.viewpoints.size(), a.clouds.size());
  std::vector<QueryCloud> clouds(a.clouds.size());
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    LoadOptions load{.units = a.units, .camera = a.camera, .viewpoint = {}};
    if (!a.viewpoints.empty()) load.viewpoint = cli::parse_vector3(a.viewpoints[i], "--viewpoint");
    if (!a.poses.empty()) clouds[i].T_query_cloud = cli::read_pose_file(a.poses[i]);
    clouds[i].cloud = load_cloud(a.clouds[i], load);
  }
  return clouds;
}

int run_query(const QueryArguments& arguments, const Program& program) {
  const QueryOptions options = query_options(arguments);
  std::vector<QueryCloud> clouds = load_query(arguments);

  Session session(program.options);
  QueryResult result = session.connect().query(clouds, options, session.context());
  session.finish();
  if (!arguments.correspondences.empty()) {
    write_correspondences(arguments.correspondences, result.correspondences);
  }
  if (!arguments.report.empty()) {
    cli::write_file(arguments.report,
                    report_html({title_of(arguments), in_one(std::move(clouds)), options}, result),
                    "--report");
    if (!arguments.explain) result.explanation.reset();
  }
  program.print(query_json(result), query_text(result));
  return query_exit_status(result.status);
}

}  // namespace landmarkdb::client
