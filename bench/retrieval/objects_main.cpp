// Cluttered scenes of generated objects, asked against catalogues of them: right, wrong, declined,
// and the evidence of the best poses as CSV for landmarkdb-bench-calibrate.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "bench/retrieval/object_catalog.hpp"
#include "bench/retrieval/object_funnel.hpp"
#include "bench/retrieval/object_tally.hpp"
#include "engine/retrieval/localizer.hpp"

namespace landmarkdb::bench {

namespace {

struct Settings {
  int catalogs = 4;
  int scenes = 12;  // a catalogue
  std::uint64_t seed = 40'000;
  std::string ground = "both";
  std::uint32_t top = 10;
  int only = -1;
  bool all = false;
  bool funnel = false;
  ObjectCatalogOptions catalog;
  int threads = 2;
};

void print_header() {
  std::puts(
      "place,frame,spread,status,right,metres,degrees,confidence,quality,overlap,explained,"
      "coverage,crossed,margin,observability,inliers,keypoints,rmse_m,agreeing,contrast,"
      "contradicted,outgrown,catalog,ms,rank,object,symmetric,unhidden,pixels,scanner,"
      "preprocess_ms,keypoints_ms,describe_ms,match_ms,pose_ms,icp_ms,verify_ms,"
      "seen_points,closeness,structure,confirmed,continued");
}

void print_row(const QueryResult& answer,
               std::size_t rank,
               const AskedScene& asked,
               std::string_view catalog,
               int number) {
  const bool any = rank < answer.hypotheses.size();
  const Hypothesis hypothesis = any ? answer.hypotheses[rank] : Hypothesis{};
  const JudgedHypothesis judged = any ? judge_hypothesis(hypothesis, asked) : JudgedHypothesis{};
  const Fit& fit = hypothesis.fit;
  std::printf("%.*s,%d,%.4f,%d,%d,%.4f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.5f,",
              static_cast<int>(catalog.size()),
              catalog.data(),
              number,
              asked.scene.frame.normal_spread,
              static_cast<int>(answer.status),
              judged.right ? 1 : 0,
              judged.metres,
              judged.degrees,
              hypothesis.confidence,
              fit.quality,
              fit.overlap,
              fit.explained,
              fit.coverage,
              fit.free_space_violation,
              fit.margin,
              fit.observability);
  std::printf("%u,%lu,%.5f,%.0f,%.4f,%.4f,%.4f,%.*s,%.0f,%zu,%s,%d,%.3f,%zu,%d,",
              hypothesis.counts.inliers,
              static_cast<unsigned long>(answer.query.keypoints),
              fit.rmse_m,
              fit.agreeing,
              fit.contrast,
              fit.contradicted,
              fit.outgrown,
              static_cast<int>(catalog.size()),
              catalog.data(),
              answer.timings.total.count(),
              rank,
              any ? hypothesis.scene.c_str() : "none",
              judged.right_symmetric ? 1 : 0,
              judged.unhidden,
              judged.pixels,
              asked.options.sensor == datasets::ObjectSensor::kScanner ? 1 : 0);
  const StageTimings& timings = answer.timings;
  std::printf("%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,",
              timings.preprocess.count(),
              timings.keypoints.count(),
              timings.describe.count(),
              timings.match.count(),
              timings.pose.count(),
              timings.icp.count(),
              timings.verify.count());
  std::printf("%.0f,%.4f,%.4f,%.4f,%.4f\n",
              fit.seen_points,
              fit.closeness,
              fit.structure,
              fit.confirmed,
              fit.continued);
  std::fflush(stdout);
}

int run(const Settings& settings) {
  RunContext context;
  context.threads = settings.threads;
  print_header();
  ObjectTally tally;
  for (int c = 0; c < settings.catalogs; ++c) {
    ObjectCatalogOptions options = settings.catalog;
    options.seed = settings.seed + static_cast<std::uint64_t>(c);
    const bool floor = settings.ground == "floor" || (settings.ground == "both" && c % 3 == 2);
    options.ground = floor ? datasets::ObjectGround::kFloor : datasets::ObjectGround::kTable;
    const ObjectCatalog objects = make_object_catalog(options, context);
    const Localizer localizer(objects.catalog, context);
    const std::string name =
        std::string(floor ? "floor-" : "table-") + std::to_string(options.seed);
    for (int s = 0; s < settings.scenes; ++s) {
      if (settings.only >= 0 && s != settings.only) continue;
      const AskedScene asked =
          make_asked_scene(objects, static_cast<std::size_t>(s), options.seed, context);
      QueryOptions query;
      query.top = settings.top;
      const QueryResult answer = localizer.query(asked.scene.frame.cloud, query, context);
      tally.add(answer, asked);
      const std::size_t rows =
          settings.all ? std::max<std::size_t>(answer.hypotheses.size(), 1) : 1;
      for (std::size_t h = 0; h < rows; ++h) print_row(answer, h, asked, name, s);
      if (settings.funnel) {
        std::printf("%s", object_funnel_text(objects, asked, query, context).c_str());
      }
    }
  }
  std::fprintf(stderr, "%s", object_tally_text(tally).c_str());
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"Objects in cluttered generated scenes: recall, false alarms, pose error"};
  app.add_option("--catalogs", settings.catalogs, "Catalogues, one after another, seeds 1 apart");
  app.add_option("--objects", settings.catalog.objects, "Objects in a catalogue");
  app.add_option("--scenes", settings.scenes, "Scenes a catalogue, a quarter of them without any");
  app.add_option("--seed", settings.seed, "Of the objects, scans, scenes and noise");
  app.add_option("--ground", settings.ground, "What they stand on; both: every third a floor")
      ->check(CLI::IsMember({"table", "floor", "both"}));
  app.add_option("--top", settings.top, "Hypotheses asked for");
  app.add_option("--only", settings.only, "Ask this scene of each catalogue alone");
  app.add_flag("--all", settings.all, "A row a hypothesis, not a row a scene");
  app.add_flag("--funnel", settings.funnel, "Say at which stage each instance was lost");
  app.add_option("--threads", settings.threads, "Threads");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
