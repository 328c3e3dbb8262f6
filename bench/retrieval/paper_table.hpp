#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/retrieval/pose_errors.hpp"

namespace landmarkdb::bench {

// Mean absolute errors, x, y, z in mm, pitch, yaw, roll in degrees.
struct PublishedRow {
  std::string place;
  std::string method;
  std::array<double, 6> errors;
};

// Table 2 of Cocias, Grigorescu, Moldoveanu 2014: its method in both places, its markers
// (ARToolKit) in the lobby.
const std::vector<PublishedRow>& published_rows();

// One of our methods in one of the places.
struct MeasuredRow {
  std::string place;
  std::string method;
  ErrorTally tally;
};

// Both as text, a place at a time, and as JSON.
std::string table_text(const std::vector<MeasuredRow>& rows);
std::string table_json(const std::vector<MeasuredRow>& rows, std::uint64_t seed);

}  // namespace landmarkdb::bench
