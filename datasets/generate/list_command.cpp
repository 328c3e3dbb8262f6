#include <cstdio>
#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "datasets/generate/commands.hpp"
#include "datasets/place.hpp"

namespace landmarkdb::datasets {
namespace {

int run(const Generator& generator) {
  nlohmann::ordered_json types = nlohmann::ordered_json::array();
  for (const PlaceType type : all_place_types()) {
    types.push_back({{"type", place_type_name(type)}, {"summary", place_type_summary(type)}});
    if (generator.json) continue;
    std::string name(place_type_name(type));
    name.resize(10, ' ');
    std::cout << name << place_type_summary(type) << '\n';
  }
  if (generator.json) std::cout << types.dump(2) << '\n';
  return 0;
}

}  // namespace

void add_list_command(CLI::App& app, Generator& generator) {
  CLI::App* command = cli::add_command(app,
                                       "list",
                                       "The types of place there are",
                                       {{"landmarkdb-generate list", "their names, a line each"}});
  command->callback([&generator] { generator.action = [&generator] { return run(generator); }; });
}

}  // namespace landmarkdb::datasets
