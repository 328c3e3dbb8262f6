#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "engine/cloud/read_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::indexer {

// "m", "mm", "cm" or "inch", as --units takes them.
std::string_view units_name(Units units);
// Error-free: UsageError for any other text.
Units parse_units(std::string_view text);

// The units in which a cloud of this extent, read as `units`, would have a size that is plausible
// for its kind; the commonest first. nullopt: none would.
std::optional<Units> guess_units(double extent_m, Units units, EntryKind kind);

// Diagonal of the points' bounding box.
double extent_of(std::span<const Eigen::Vector3f> points);

// What to tell the user whose record carries the warning "units_suspect".
std::string units_hint(double extent_m, Units units, EntryKind kind);

}  // namespace landmarkdb::indexer
