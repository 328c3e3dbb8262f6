#include <algorithm>
#include <cstring>
#include <limits>

#include "engine/base/parallel.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kStep = 4096;  // points between two looks at the stop token

// A row of a block; half of it fits a register of the least machine.
using Floats = float __attribute__((vector_size(32)));
using Numbers = std::uint32_t __attribute__((vector_size(32)));

float square(float value) { return value * value; }

// Names `surfel` in the cells of a row to which it is nearer than what they name.
void name_in_row(const Floats& distance,
                 float most,
                 std::uint32_t surfel,
                 float* nearest,
                 std::uint32_t* named) {
  Floats near;
  Numbers names;
  std::memcpy(&near, nearest, sizeof near);
  std::memcpy(&names, named, sizeof names);
  const auto closer = (distance < near) & (distance <= Floats{} + most);
  near = closer ? distance : near;
  names = closer ? Numbers{} + surfel : names;
  std::memcpy(nearest, &near, sizeof near);
  std::memcpy(named, &names, sizeof names);
}

}  // namespace

float SurfaceGrid::most_squared() const {
  return reach_m() * reach_m() + 0.75F * cell_m_ * cell_m_;  // to a cell's far corner
}

// Calls `visit` with each block that has a cell within reach of `p`.
template <typename Visit>
void SurfaceGrid::visit_blocks(const Eigen::Vector3f& p, const Visit& visit) const {
  const Cell home = cell_of(p);
  const Cell low = block_of((home.array() - reach_).matrix());
  const Cell high = block_of((home.array() + reach_).matrix());
  // From `p` to the nearest cell of a block, along one axis.
  const auto least = [&](int axis, int block) {
    const int nearest =
        std::clamp(home[axis], block * kBlockSide, block * kBlockSide + kBlockSide - 1);
    return square(middle(nearest) - p[axis]);
  };
  for (int z = low.z(); z <= high.z(); ++z) {
    const float along_z = least(2, z);
    for (int y = low.y(); y <= high.y(); ++y) {
      const float beside = least(1, y) + along_z;
      for (int x = low.x(); x <= high.x(); ++x) {
        if (least(0, x) + beside <= most_squared()) visit(Cell(x, y, z));
      }
    }
  }
}

// The surfels `first` to before `end`: sorted by block, then each block is filled by one thread.
void SurfaceGrid::insert(std::uint32_t first,
                         std::uint32_t end,
                         std::vector<Cell>& places,
                         const RunContext& context) {
  struct Pair {
    std::uint32_t block, surfel;
  };
  std::vector<Pair> pairs;
  for (std::uint32_t surfel = first; surfel < end; ++surfel) {
    if ((surfel - first) % kStep == 0) context.check("grid");
    check_blocks(places.size(), surfel - 1, surfels_.size() - 1, static_cast<double>(cell_m_));
    visit_blocks(surfels_[surfel].point, [&](const Cell& block) {
      pairs.push_back({number_of(block, places), surfel});
    });
  }
  std::vector<std::uint32_t> begin(places.size() + 1, 0);
  for (const Pair& pair : pairs) ++begin[pair.block + 1];
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<std::uint32_t> sorted(pairs.size());
  std::vector<std::uint32_t> next = begin;
  for (const Pair& pair : pairs) sorted[next[pair.block]++] = pair.surfel;

  blocks_.resize(places.size(), Block{});
  parallel_chunks(places.size(), context.threads, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      if ((k - from) % kStep == 0) context.check("grid");
      if (begin[k] == begin[k + 1]) continue;
      const std::span surfels = std::span(sorted).subspan(begin[k], begin[k + 1] - begin[k]);
      fill_block(blocks_[k], places[k], surfels);
    }
  });
}

// Squared distances from the middle of each cell of a block to the surfel that it names.
void SurfaceGrid::measure_block(const Block& block,
                                const Cell& low,
                                std::array<float, kBlockCells>& nearest) const {
  nearest.fill(std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (block[i] == 0) continue;
    const auto cell = static_cast<int>(i);
    const Eigen::Vector3f centre(middle(low.x() + cell % kBlockSide),
                                 middle(low.y() + cell / kBlockSide % kBlockSide),
                                 middle(low.z() + cell / kBlockSide / kBlockSide));
    nearest[i] = (centre - surfels_[block[i]].point).squaredNorm();
  }
}

// Of surfels as near to a cell the first one named stays.
void SurfaceGrid::fill_block(Block& block,
                             const Cell& place,
                             std::span<const std::uint32_t> surfels) const {
  const Cell low = place * kBlockSide;
  std::array<float, kBlockCells> nearest;
  measure_block(block, low, nearest);
  const float most = most_squared();
  for (const std::uint32_t surfel : surfels) {
    const Eigen::Vector3f p = surfels_[surfel].point;
    const Cell home = cell_of(p) - low;
    Floats along_x;
    for (int x = 0; x < kBlockSide; ++x) {
      const bool in_reach = x >= home.x() - reach_ && x <= home.x() + reach_;
      along_x[x] =
          in_reach ? square(middle(low.x() + x) - p.x()) : std::numeric_limits<float>::infinity();
    }
    const int last_z = std::min(kBlockSide - 1, home.z() + reach_);
    const int last_y = std::min(kBlockSide - 1, home.y() + reach_);
    for (int z = std::max(0, home.z() - reach_); z <= last_z; ++z) {
      const float along_z = square(middle(low.z() + z) - p.z());
      for (int y = std::max(0, home.y() - reach_); y <= last_y; ++y) {
        const float beside = square(middle(low.y() + y) - p.y()) + along_z;
        if (beside > most) continue;
        const auto row = static_cast<std::size_t>((z * kBlockSide + y) * kBlockSide);
        name_in_row(along_x + beside, most, surfel, nearest.data() + row, block.data() + row);
      }
    }
  }
}

}  // namespace landmarkdb
