#include <algorithm>
#include <limits>

#include "engine/base/parallel.hpp"
#include "engine/registration/name_cells.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kStep = 4096;  // points between two looks at the stop token

float square(float value) { return value * value; }

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

  const std::size_t known = blocks_.size();
  blocks_.resize(places.size(), Block{});
  parallel_chunks(places.size(), context.threads, [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      if ((k - from) % kStep == 0) context.check("grid");
      if (begin[k] == begin[k + 1]) continue;
      const std::span surfels = std::span(sorted).subspan(begin[k], begin[k + 1] - begin[k]);
      fill_block(blocks_[k], places[k], k >= known, surfels);
    }
  });
}

// Squared distances from the middle of each cell of a block to the surfel that it names, where it
// names one.
void SurfaceGrid::measure_block(const Block& block,
                                const Cell& low,
                                std::array<float, kBlockCells>& nearest) const {
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    if (block[i] == 0) continue;
    const auto cell = static_cast<int>(i);
    const Eigen::Vector3f centre(middle(low.x() + cell % kBlockSide),
                                 middle(low.y() + cell / kBlockSide % kBlockSide),
                                 middle(low.z() + cell / kBlockSide / kBlockSide));
    nearest[i] = (centre - surfels_[block[i]].point).squaredNorm();
  }
}

void SurfaceGrid::fill_block(Block& block,
                             const Cell& place,
                             bool is_new,
                             std::span<const std::uint32_t> surfels) const {
  static_assert(BlockFill::kSide == kBlockSide && sizeof(Surfel) % sizeof(float) == 0);
  const Cell low = place * kBlockSide;
  std::array<float, kBlockCells> nearest;
  nearest.fill(std::numeric_limits<float>::infinity());
  if (!is_new) measure_block(block, low, nearest);
  BlockFill fill{.named = block.data(),
                 .nearest_m2 = nearest.data(),
                 .inverse_cell = inverse_cell_,
                 .reach = reach_,
                 .most_m2 = most_squared(),
                 .surfels = surfels};
  for (int axis = 0; axis < 3; ++axis) {
    fill.first_cell[axis] = low[axis];
    for (int i = 0; i < kBlockSide; ++i) fill.middle_m[axis][i] = middle(low[axis] + i);
  }
  cell_namer()(fill, surfels_.front().point.data(), sizeof(Surfel) / sizeof(float));
}

}  // namespace landmarkdb
