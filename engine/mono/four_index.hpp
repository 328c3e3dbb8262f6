#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// How three links hold four points together: one after the other, or three at one.
enum class FourShape : std::uint8_t { kPath, kStar };

// The types of four points in their order, 2 bits each, the first lowest.
template <typename TypeOf>
std::uint8_t four_signature(const std::array<std::uint16_t, 4>& ids, const TypeOf& type_of) {
  unsigned signature = 0;
  for (std::size_t k = 0; k < 4; ++k) signature |= static_cast<unsigned>(type_of(ids[k])) << 2 * k;
  return static_cast<std::uint8_t>(signature);
}

// Orders of a four's points that are the same path, or the same star, in which a model's four may
// stand in the index. Of fours whose types differ only one is stored: the one with the smallest
// signature.
std::span<const std::array<std::uint8_t, 4>> orders_of(FourShape shape);

// Four points of a model that three of its edges join.
struct ModelFour {
  std::uint32_t model = 0;  // index into the search models
  FourShape shape = FourShape::kPath;
  std::array<std::uint16_t, 4> ids{};  // along the path; of a star the middle first
  std::uint8_t links = 0;              // which pairs are edges, as link_mask counts them
  std::bitset<kModelViews> views{};    // where all four are seen, and the views next to these
};

// The fours of all models by shape and types, with what the test of orthography needs.
//
// Seen from far away the four's differences w (complex image coordinates of points 1, 2, 3 less
// that of point 0) satisfy w^T G w = 0 with G = (E E^T)^-1, the rows of E the same differences of
// the model's points in space: both rows of the camera's rotation, E^-1 Re w and E^-1 Im w, are
// orthogonal and equally long (Poelman & Kanade 1997 put scaled orthography so). w^H G w is twice
// the square of image size over depth.
//
// Flat fours have no such test and are not stored. Built once a catalogue; const members are
// thread-safe. 80 bytes a four, some thousand fours a model of twenty points.
class FourIndex {
 public:
  explicit FourIndex(std::span<const SearchModel> models, int threads = 1);

  // Fours of one shape and signature: `size` of them from `first` on, filled up to a multiple of
  // kLanes with fours that pass no test.
  struct Group {
    std::size_t first = 0, size = 0;
  };
  Group group(FourShape shape, std::uint8_t signature) const {
    return groups_[static_cast<std::size_t>(shape) * 256 + signature];
  }
  const ModelFour& operator[](std::size_t i) const { return fours_[i]; }
  // Element k (00, 11, 22, 01, 02, 12) of G of four i on.
  const float* metric(std::size_t k, std::size_t i) const { return metric_[k].data() + i; }

  // Whether many of a model's fours are flat, as those of boxes and boards are, or it has none: the
  // index does not hold what is likely to be seen of it.
  bool often_flat(std::uint32_t model) const { return often_flat_[model]; }

  static constexpr std::size_t kLanes = 16;

 private:
  std::array<Group, 512> groups_{};
  std::vector<ModelFour> fours_;
  std::array<std::vector<float>, 6> metric_;
  std::vector<bool> often_flat_;
};

// The fours of one model, as the index stores them, and how many more are flat; `number` is its
// index.
struct ModelFours {
  std::vector<ModelFour> fours{};
  std::size_t flat = 0;
};
ModelFours fours_of(const SearchModel& model, std::uint32_t number);

}  // namespace landmarkdb
