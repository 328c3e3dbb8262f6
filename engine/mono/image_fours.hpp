#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/mono/four_index.hpp"
#include "engine/mono/image_view.hpp"

namespace landmarkdb {

// Four of an image's points that three links hold together: along the path; of a star the middle
// first.
struct ImageFour {
  std::array<std::uint16_t, 4> ids{};
  FourShape shape = FourShape::kPath;
};

struct ImageFours {
  std::vector<ImageFour> fours{};
  bool cut_short = false;  // there were more than `most`
};

// Each four of linked points once, as a path where it has one; in an order that is by chance, but
// the same each time. An even sample of about `most` where there are more.
ImageFours linked_fours(const ImageView& image, std::size_t most);

}  // namespace landmarkdb
