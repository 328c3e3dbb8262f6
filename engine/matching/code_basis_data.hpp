#pragma once

#include <cstdint>

namespace landmarkdb {

// What landmarkdb-fit-basis wrote; see code_basis.hpp.
extern const float kCodeStep;
extern const std::int32_t kCodeMeans[];  // kCodeComponents
// kCodeComponents x kShotLength bytes in base 64, each a component's element + 128.
extern const char kCodeComponentDigits[];

}  // namespace landmarkdb
