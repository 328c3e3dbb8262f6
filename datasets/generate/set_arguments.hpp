#pragma once

#include <cstdint>
#include <string>

#include <CLI/App.hpp>

#include "datasets/place.hpp"
#include "datasets/place_files.hpp"

namespace landmarkdb::datasets {

// What `place` and `many` have in common, as typed.
struct SetArguments {
  std::string type = "lobby";
  std::uint64_t seed = 1;
  std::string out;
  double size = 1.0;
  double clutter = 1.0;
  int floors = 0;
  int stations = 0;
  std::string copies = "look-alike";
  std::uint64_t day = 0;
  std::uint64_t twin = 0;
  std::size_t points = 500'000;
  std::size_t queries = 10;
  std::size_t query_points = 0;
  std::string sensor = "depth";
  double noise_m = 0.006;
  double max_range_m = 8.0;
  bool any_roll = false;
  bool organised = false;
  bool ideal = false;
};

void add_set_options(CLI::App& command, SetArguments& arguments);

PlaceOptions place_options_of(const SetArguments& arguments);
SetOptions set_options_of(const SetArguments& arguments);

}  // namespace landmarkdb::datasets
