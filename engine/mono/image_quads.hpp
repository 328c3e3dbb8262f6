#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mono/image_view.hpp"
#include "engine/mono/quad_code.hpp"

namespace landmarkdb {

// Four of an image's points whose code is looked up.
struct ImageQuad {
  std::array<std::uint16_t, 4> ids{};  // A, B, C, D
  std::array<float, 4> code{};
  std::uint8_t signature = 0;
  float length_px = 0.0F;  // of AB
};

struct ImageQuads {
  std::vector<ImageQuad> quads{};
  bool cut_short = false;  // there were more than `most`
};

// Fours with three links among them that hang together: chains and stars.
ImageQuads chained_quads(const ImageView& image, std::size_t most);

// Fours with two links among them and no more; an even sample of `most` where there are more.
ImageQuads linked_quads(const ImageView& image, std::size_t most);

// Fours of any points of the types whose bits are set: each pair with those nearest to its middle.
ImageQuads free_quads(const ImageView& image, unsigned types, std::size_t most);

}  // namespace landmarkdb
