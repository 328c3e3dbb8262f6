#include "datasets/generate/set_arguments.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

namespace landmarkdb::datasets {

void add_set_options(CLI::App& command, SetArguments& arguments) {
  command.add_option("--out", arguments.out, "The folder to write to; made if need be")
      ->type_name("DIR")
      ->required();
  command.add_option("--seed", arguments.seed, "Same seed, same files, byte for byte (1)")
      ->type_name("N");
  command.add_option("--size", arguments.size, "Scales length and width of the place (1)")
      ->type_name("FACTOR")
      ->check(CLI::Range(0.3, 3.0));
  command.add_option("--clutter", arguments.clutter, "How much loose clutter stands around (1)")
      ->type_name("FACTOR")
      ->check(CLI::Range(0.0, 4.0));
  command
      .add_option(
          "--stations", arguments.stations, "Stations of the laser scanner a floor (by type)")
      ->type_name("N")
      ->check(CLI::Range(1, 100));
  command.add_option("--points", arguments.points, "Points of all stations together, exactly")
      ->type_name("N")
      ->check(CLI::Range(1'000, 200'000'000));
  command.add_option("--noise", arguments.noise_m, "Scanner noise, standard deviation (0.006)")
      ->type_name("M")
      ->check(CLI::Range(0.0, 0.5));
  command.add_option("--queries", arguments.queries, "How many queries to take")
      ->type_name("N")
      ->check(CLI::Range(0, 100'000));
  command
      .add_option("--query-points",
                  arguments.query_points,
                  "Exactly so many points a query; 0: all the sensor saw (0)")
      ->type_name("N")
      ->check(CLI::Range(0, 16'000'000));
  command
      .add_option("--sensor",
                  arguments.sensor,
                  "What takes the queries: a depth camera of 640 x 480 or a laser of 16 lines")
      ->check(CLI::IsMember({"depth", "lidar"}));
  command.add_option("--max-range", arguments.max_range_m, "Range of the depth camera (8)")
      ->type_name("M")
      ->check(CLI::Range(0.6, 30.0));
  command.add_flag("--any-roll", arguments.any_roll, "Cameras turned any way about their view");
  command.add_flag("--organised",
                   arguments.organised,
                   "Depth frames as PCD of 640 x 480, NaN where there is no depth");
  command.add_flag("--ideal", arguments.ideal, "Sensors without noise, holes or mixed pixels");
}

PlaceOptions place_options_of(const SetArguments& arguments) {
  PlaceOptions options;
  options.type = place_type_from_name(arguments.type);
  options.seed = arguments.seed;
  options.size = arguments.size;
  options.clutter = arguments.clutter;
  options.floors = arguments.floors;
  options.copies = arguments.copies == "exact"            ? FloorCopies::kExact
                   : arguments.copies == "one-difference" ? FloorCopies::kOneDifference
                                                          : FloorCopies::kLookAlike;
  options.day = arguments.day;
  options.twin = arguments.twin;
  options.stations = arguments.stations;
  return options;
}

SetOptions set_options_of(const SetArguments& arguments) {
  SetOptions options;
  options.seed = arguments.seed;
  options.scanner.seed = arguments.seed;
  options.scanner.points = arguments.points;
  options.scanner.noise_m = arguments.noise_m;
  options.queries = arguments.queries;
  options.query_points = arguments.query_points;
  options.sensor = arguments.sensor == "lidar" ? QuerySensor::kLidar : QuerySensor::kDepthCamera;
  options.camera.max_range_m = arguments.max_range_m;
  options.sampling.any_roll = arguments.any_roll;
  options.organised = arguments.organised;
  if (arguments.ideal) {
    options.scanner.noise_m = options.scanner.mixed_pixels = options.scanner.dropout = 0.0;
    options.lidar.noise_m = options.lidar.mixed_pixels = 0.0;
    options.camera.noise_scale = options.camera.edge_holes = options.camera.grazing_rad = 0.0;
    options.camera.quantise = options.camera.shadows = false;
  }
  return options;
}

}  // namespace landmarkdb::datasets
