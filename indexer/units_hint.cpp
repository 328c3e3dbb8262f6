#include "indexer/units_hint.hpp"

#include <array>
#include <cstdio>

#include <Eigen/Geometry>

#include "cli/usage_error.hpp"
#include "engine/cloud/resolution.hpp"

namespace landmarkdb::indexer {
namespace {

// Commonest mistake first: scanners and CAD write millimetres.
constexpr std::array kAllUnits = {
    Units::kMillimetres, Units::kMetres, Units::kCentimetres, Units::kInches};

std::string metres_text(double metres) {
  char text[48];
  std::snprintf(text, sizeof text, metres >= 100.0 ? "%.0f m" : "%.3g m", metres);
  return text;
}

}  // namespace

std::string_view units_name(Units units) {
  switch (units) {
    case Units::kMetres:
      return "m";
    case Units::kMillimetres:
      return "mm";
    case Units::kCentimetres:
      return "cm";
    case Units::kInches:
      return "inch";
  }
  return "m";
}

Units parse_units(std::string_view text) {
  for (const Units units : kAllUnits) {
    if (units_name(units) == text) return units;
  }
  throw cli::UsageError("--units", '"' + std::string(text) + "\" is not one of m, mm, cm, inch");
}

std::optional<Units> guess_units(double extent_m, Units units, EntryKind kind) {
  const double in_file = extent_m / metres_per(units);
  for (const Units candidate : kAllUnits) {
    const CloudScale scale{.extent_m = in_file * metres_per(candidate)};
    if (candidate != units && !units_look_wrong(scale, kind)) return candidate;
  }
  return std::nullopt;
}

double extent_of(std::span<const Eigen::Vector3f> points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  return box.isEmpty() ? 0.0 : static_cast<double>(box.diagonal().norm());
}

std::string units_hint(double extent_m, Units units, EntryKind kind) {
  const std::string what = kind == EntryKind::kPlace ? "a place" : "an object";
  std::string text = "warning: units_suspect: read in " + std::string(units_name(units)) +
                     ", this is " + metres_text(extent_m) + " across, unlikely for " + what + ".";
  const std::optional<Units> guess = guess_units(extent_m, units, kind);
  if (guess) {
    const double factor = metres_per(*guess) / metres_per(units);
    char factor_text[32];
    std::snprintf(factor_text, sizeof factor_text, "%g", factor);
    text += " Are the file's numbers " + std::string(units_name(*guess)) +
            "? Then add it with --units " + std::string(units_name(*guess)) + " (a factor of " +
            factor_text + ", " + metres_text(extent_m * factor) + " across).";
  }
  return text;
}

}  // namespace landmarkdb::indexer
