#pragma once

#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {

// Throws Error{kInvalidArgument} that names a field of a request.
[[noreturn]] inline void refuse(const std::string& field, const std::string& message) {
  throw Error(ErrorCode::kInvalidArgument, field + ": " + message, field);
}

// The value, where it lies between the two; NaN lies nowhere.
inline double in_range(double value, double low, double high, const std::string& field) {
  if (!(value >= low && value <= high)) {
    refuse(field,
           "is " + std::to_string(value) + ", want " + std::to_string(low) + " to " +
               std::to_string(high));
  }
  return value;
}

}  // namespace landmarkdb
