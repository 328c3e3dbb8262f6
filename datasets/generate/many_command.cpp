#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "datasets/generate/commands.hpp"
#include "datasets/generate/job.hpp"
#include "datasets/generate/set_arguments.hpp"
#include "datasets/place_files.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

struct ManyArguments {
  SetArguments set;
  std::size_t count = 200;
  double look_alikes = 0.2;
};

// The i-th place: types in turn, sizes drawn; some are twins of the one before of their type.
PlaceOptions nth_place(const ManyArguments& arguments, std::size_t i) {
  const bool any = arguments.set.type == "any";
  const std::size_t types = all_place_types().size();
  SetArguments set = arguments.set;
  if (any) set.type = place_type_name(all_place_types()[i % types]);
  PlaceOptions options = place_options_of(set);
  options.seed = set.seed + i;
  const std::size_t step = any ? types : 1;
  Random random(arguments.set.seed * 1'000'003 + i);
  if (i >= step && random.uniform() < arguments.look_alikes) {
    options.seed -= step;
    options.twin = i;
    i -= step;
  }
  Random size(arguments.set.seed * 7'368'787 + i);  // a twin has the size of its model
  options.size *= size.uniform(0.75, 1.1);
  return options;
}

int run(const ManyArguments& arguments, const Generator& generator) {
  Job job(generator);
  const std::filesystem::path root = arguments.set.out;
  nlohmann::ordered_json places = nlohmann::ordered_json::array();
  std::size_t points = 0;
  std::size_t queries = 0;
  for (std::size_t i = 0; i < arguments.count; ++i) {
    job.context().report("places", i, arguments.count);
    char folder[32];
    std::snprintf(folder, sizeof folder, "place-%04zu", i);
    SetOptions options = set_options_of(arguments.set);
    options.seed = options.scanner.seed = arguments.set.seed + i;
    const PlaceSet set = write_place_set(
        make_place(nth_place(arguments, i)), root / folder, options, job.quiet_context());
    points += set.points;
    queries += set.queries;
    places.push_back({{"name", set.name},
                      {"folder", folder},
                      {"points", set.points},
                      {"queries", set.queries},
                      {"index_command", set.index_command}});
  }
  job.finish_progress();
  const nlohmann::ordered_json manifest = {{"licence", "CC0-1.0"},
                                           {"seed", arguments.set.seed},
                                           {"points", points},
                                           {"queries", queries},
                                           {"places", places}};
  std::ofstream out(root / "manifest.json");
  out << manifest.dump(1) << '\n';
  out.close();
  if (!out) {
    throw Error(ErrorCode::kResourceExhausted,
                (root / "manifest.json").string() + ": cannot be written");
  }
  if (generator.json) {
    std::cout << manifest.dump(2) << '\n';
  } else {
    std::cout << arguments.count << " places, " << points << " points and " << queries
              << " queries in " << arguments.set.out << '\n';
  }
  return 0;
}

}  // namespace

void add_many_command(CLI::App& app, Generator& generator) {
  const auto arguments = std::make_shared<ManyArguments>();
  arguments->set.type = "any";
  arguments->set.points = 60'000;
  arguments->set.queries = 2;
  arguments->set.stations = 4;
  arguments->set.floors = 1;
  CLI::App* command = cli::add_command(
      app,
      "many",
      "Make many small places quickly, some of them look-alikes, a folder each",
      {{"landmarkdb-generate many --count 200 --seed 1000 --out many",
        "200 places of all types, two queries each"},
       {"landmarkdb-generate many --type office --count 50 --look-alikes 0.5 --out offices",
        "half of them furnished anew after the plan of the one before"}});
  std::vector<std::string> types = {"any"};
  for (const PlaceType type : all_place_types()) types.emplace_back(place_type_name(type));
  command->add_option("--type", arguments->set.type, "What kind of place; any: all in turn (any)")
      ->check(CLI::IsMember(types));
  command->add_option("--count", arguments->count, "How many places (200)")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000));
  command->add_option("--look-alikes", arguments->look_alikes, "Share of look-alikes (0.2)")
      ->type_name("SHARE")
      ->check(CLI::Range(0.0, 1.0));
  add_set_options(*command, arguments->set);
  command->callback([arguments, &generator] {
    generator.action = [arguments, &generator] { return run(*arguments, generator); };
  });
}

}  // namespace landmarkdb::datasets
