#include "engine/registration/name_cells.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "engine/base/instruction_sets.hpp"
#include "engine/base/round_down.hpp"

namespace landmarkdb {

namespace {

constexpr int kRows = 2;  // of a block, one behind the other
constexpr std::size_t kLanes = kRows * BlockFill::kSide;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Cells __attribute__((vector_size(kLanes * sizeof(std::int32_t))));
typedef std::uint32_t Numbers __attribute__((vector_size(kLanes * sizeof(std::uint32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/registration/name_cells_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<CellNamer> kSets LANDMARKDB_KERNEL_SETS(name_cells);

}  // namespace

CellNamer cell_namer(const char* instruction_set) { return kSets.named(instruction_set); }

CellNamer cell_namer() {
  static const CellNamer best = kSets.best();
  return best;
}

}  // namespace landmarkdb
