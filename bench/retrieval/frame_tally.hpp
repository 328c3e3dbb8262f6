#pragma once

#include <string>
#include <vector>

#include "engine/types/query.hpp"

namespace landmarkdb::bench {

// One frame that was asked, and what came back.
struct AskedFrame {
  std::string place;  // it was taken in; empty: one that is not in the catalogue (a stranger)
  int catalog = 0;    // number of the catalogue
  int number = 0;     // of the frame in its place
  bool gravity = false;
  double normal_spread = 0.0;  // datasets::DepthFrame
  double scanned = 0.0;        // share of its points that lie near the stored surface at the truth
  QueryStatus status = QueryStatus::kNotFound;
  double metres = 1e9;  // of the best pose, from the truth; far where it names another place
  double degrees = 180.0;
  double milliseconds = 0.0;

  bool stranger() const { return place.empty(); }
  bool first() const;  // the best pose is right
  bool right() const { return status == QueryStatus::kLocalized && first(); }
  bool wrong() const { return status == QueryStatus::kLocalized && !first(); }
};

// Frames that fix all six freedoms as a rule have normals spread as wide as this.
inline constexpr double kInformativeSpread = 0.03;
// Frames of which the scan holds as much as this.
inline constexpr double kMostlyScanned = 0.75;

// What came of some of the frames; shares and medians of none are 0.
struct FrameTally {
  std::size_t asked = 0, first = 0, right = 0, wrong = 0, ambiguous = 0, not_found = 0;
  double median_m = 0.0, median_deg = 0.0;  // of those right
  double median_ms = 0.0, p95_ms = 0.0;     // of all
};

FrameTally tally(const std::vector<AskedFrame>& frames);

// The rows of the report: without and with gravity, all frames of known places, the informative
// ones, those of them that the scan mostly holds, and strangers.
struct TallyRow {
  std::string name;
  FrameTally tally;
};
std::vector<TallyRow> tally_rows(const std::vector<AskedFrame>& frames);

// A table for people, and the same as JSON with `settings` (what was asked, as text) in it.
std::string tally_table(const std::vector<TallyRow>& rows);
std::string tally_json(const std::vector<TallyRow>& rows, const std::string& settings);

}  // namespace landmarkdb::bench
