#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/quad_code.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// Four points of a model as they look from one of its views, from far away.
struct ModelQuad {
  std::uint32_t model = 0;  // index into the search models
  std::uint8_t view = 0;
  std::uint8_t signature = 0;          // the types of A, B, C, D, 2 bits each, A lowest
  std::uint8_t links = 0;              // which of AB, AC, AD, BC, BD, CD are edges, AB lowest
  std::array<std::uint16_t, 4> ids{};  // A, B, C, D
  std::array<float, 4> code{};
  float length_m = 0.0F;  // of AB
  float origin_x = 0.0F;  // the model's center, in the frame of AB
  float origin_y = 0.0F;
  float angle_rad = 0.0F;  // of AB in the view's own image
};

// All quads of models, by type signature and cell of the code.
//
// Built once a catalogue; const members are thread-safe. 44 bytes a quad, at most 150 a view.
class QuadIndex {
 public:
  // Of the `wanted` models, by number (empty: all). Quads that a search model leaves out are read
  // from its record. On `context.threads` threads; throws what `context.check` does.
  explicit QuadIndex(std::span<const SearchModel> models,
                     const RunContext& context = {},
                     std::span<const char> wanted = {});

  // Calls visit(quad) for each stored quad of this signature whose code is within `tolerance` of
  // `code` in each coordinate.
  template <typename Visit>
  void near(std::uint8_t signature,
            const std::array<float, 4>& code,
            float tolerance,
            const Visit& visit) const;

  std::span<const ModelQuad> quads() const { return quads_; }

 private:
  static constexpr std::size_t kCells = 14;  // a coordinate: some 0.1 of code each
  static constexpr std::size_t kBlock = kCells * kCells * kCells * kCells;

  static std::size_t cell(float coordinate) {
    const double at = (coordinate - kCodeLow) / (kCodeHigh - kCodeLow) * double{kCells};
    return at <= 0.0 ? 0 : std::min(kCells - 1, static_cast<std::size_t>(at));
  }

  // Sorts quads of one signature and first cell, which lie at [begin, end), by the other cells.
  void sort_slab(std::size_t slab, std::uint32_t begin, std::uint32_t end);

  std::vector<ModelQuad> quads_;
  std::array<std::int32_t, 256> block_of_{};  // by signature; -1: no such quads
  std::vector<std::uint32_t> starts_;         // kBlock cells and an end a block, into quads_
};

// The chosen quads of one model, view by view, as the index stores them; `number` is its index.
std::vector<ModelQuad> quads_of(const SearchModel& model,
                                std::uint32_t number,
                                std::span<const ChosenQuad> chosen);

template <typename Visit>
void QuadIndex::near(std::uint8_t signature,
                     const std::array<float, 4>& code,
                     float tolerance,
                     const Visit& visit) const {
  if (block_of_[signature] < 0) return;
  const std::uint32_t* starts =
      starts_.data() + static_cast<std::size_t>(block_of_[signature]) * (kBlock + 1);
  std::array<std::size_t, 4> low, high;
  for (std::size_t k = 0; k < 4; ++k) {
    low[k] = cell(code[k] - tolerance);
    high[k] = cell(code[k] + tolerance);
  }
  for (std::size_t i = low[0]; i <= high[0]; ++i) {
    for (std::size_t j = low[1]; j <= high[1]; ++j) {
      for (std::size_t k = low[2]; k <= high[2]; ++k) {
        const std::size_t row = ((i * kCells + j) * kCells + k) * kCells;
        for (std::uint32_t q = starts[row + low[3]]; q < starts[row + high[3] + 1]; ++q) {
          const ModelQuad& quad = quads_[q];
          if (std::abs(quad.code[0] - code[0]) <= tolerance &&
              std::abs(quad.code[1] - code[1]) <= tolerance &&
              std::abs(quad.code[2] - code[2]) <= tolerance &&
              std::abs(quad.code[3] - code[3]) <= tolerance) {
            visit(quad);
          }
        }
      }
    }
  }
}

}  // namespace landmarkdb
