#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// As files and answers spell the types, by their number.
inline constexpr std::array<std::string_view, kFeatureTypes> kFeatureTypeNames{
    "vertex", "conic_centre", "centroid", "inflexion"};

constexpr std::string_view feature_type_name(FeatureType type) {
  return kFeatureTypeNames[static_cast<std::size_t>(type)];
}

constexpr std::optional<FeatureType> feature_type_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kFeatureTypes; ++i) {
    if (kFeatureTypeNames[i] == name) return static_cast<FeatureType>(i);
  }
  return std::nullopt;
}

}  // namespace landmarkdb
