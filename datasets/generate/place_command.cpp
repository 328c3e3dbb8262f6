#include <iostream>
#include <memory>
#include <string>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "datasets/generate/commands.hpp"
#include "datasets/generate/job.hpp"
#include "datasets/generate/set_arguments.hpp"
#include "datasets/place_files.hpp"

namespace landmarkdb::datasets {
namespace {

// The sizes of the paper's two places and queries.
void use_paper_sizes(SetArguments& arguments) {
  if (arguments.type == "temple") {
    arguments.points = kPaperTemplePoints;
    arguments.query_points = kPaperTempleQueryPoints;
  } else if (arguments.type == "lobby") {
    arguments.points = kPaperLobbyPoints;
    arguments.query_points = kPaperLobbyQueryPoints;
  } else {
    throw cli::UsageError("--paper", "only temple and lobby have sizes in the paper");
  }
}

int run(const SetArguments& arguments, const Generator& generator) {
  Job job(generator);
  const Place place = make_place(place_options_of(arguments));
  const PlaceSet set =
      write_place_set(place, arguments.out, set_options_of(arguments), job.context());
  job.finish_progress();
  if (generator.json) {
    const nlohmann::ordered_json object = {{"name", set.name},
                                           {"folder", arguments.out},
                                           {"points", set.points},
                                           {"queries", set.queries},
                                           {"informative", set.informative},
                                           {"index_command", set.index_command}};
    std::cout << object.dump(2) << '\n';
    return 0;
  }
  std::cout << set.name << ": " << set.points << " points from " << place.stations.size()
            << " stations, " << set.queries << " queries";
  if (arguments.sensor == "depth") std::cout << " (" << set.informative << " informative)";
  std::cout << " in " << arguments.out << "\n\nTo index it:\n  cd '" << arguments.out << "' && "
            << set.index_command << '\n';
  return 0;
}

}  // namespace

void add_place_command(CLI::App& app, Generator& generator) {
  const auto arguments = std::make_shared<SetArguments>();
  const auto paper = std::make_shared<bool>(false);
  CLI::App* command = cli::add_command(
      app,
      "place",
      "Make one place: the clouds of its scanner stations, queries, and the truth about them",
      {{"landmarkdb-generate place --type lobby --seed 1 --out lobby", "a lobby, 500,000 points"},
       {"landmarkdb-generate place --type lobby --paper --queries 20 --out lobby",
        "2,798,245 points, queries of 4,097"},
       {"landmarkdb-generate place --type corridor --floors 4 --copies exact --out tower",
        "four storeys no frame can tell apart"},
       {"landmarkdb-generate place --type hall --sensor lidar --out hall",
        "queries of a laser of 16 lines"}});
  std::vector<std::string> types;
  for (const PlaceType type : all_place_types()) types.emplace_back(place_type_name(type));
  command->add_option("--type", arguments->type, "What kind of place (lobby)")
      ->check(CLI::IsMember(types));
  add_set_options(*command, *arguments);
  command->add_option("--floors", arguments->floors, "Storeys (1; 3 of a corridor)")
      ->type_name("N")
      ->check(CLI::Range(1, 20));
  command->add_option("--copies", arguments->copies, "How much the storeys differ (look-alike)")
      ->check(CLI::IsMember({"look-alike", "one-difference", "exact"}));
  command->add_option("--day", arguments->day, "Another number: loose clutter stands elsewhere (0)")
      ->type_name("N");
  command
      ->add_option("--twin",
                   arguments->twin,
                   "Another number: another building of the same plan, furnished anew (0)")
      ->type_name("N");
  command->add_flag("--paper", *paper, "Points and queries as many as in the paper's set-up");
  command->callback([arguments, paper, &generator] {
    generator.action = [arguments, paper, &generator] {
      if (*paper) use_paper_sizes(*arguments);
      return run(*arguments, generator);
    };
  });
}

}  // namespace landmarkdb::datasets
