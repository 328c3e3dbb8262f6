#include "engine/mono/image_fours.hpp"

#include <algorithm>
#include <tuple>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using Ids = std::array<std::uint16_t, 4>;

struct Found {
  Ids sorted{};
  ImageFour four{};
};

ImageFour four_of(FourShape shape, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
  return {{static_cast<std::uint16_t>(a),
           static_cast<std::uint16_t>(b),
           static_cast<std::uint16_t>(c),
           static_cast<std::uint16_t>(d)},
          shape};
}

double count_fours(const ImageView& image) {
  double total = 0.0;
  for (std::size_t b = 0; b < image.size(); ++b) {
    const double degree = static_cast<double>(image[b].links.size());
    total += degree * (degree - 1.0) * (degree - 2.0) / 6.0;
    for (const std::uint16_t c : image[b].links) {
      if (c > b) total += (degree - 1.0) * (static_cast<double>(image[c].links.size()) - 1.0);
    }
  }
  return total;
}

}  // namespace

ImageFours linked_fours(const ImageView& image, std::size_t most) {
  ImageFours result;
  const double total = count_fours(image);
  const double chance = total > static_cast<double>(most) ? static_cast<double>(most) / total : 1.0;
  result.cut_short = chance < 1.0;
  Random random(most);
  std::vector<Found> found;
  const auto add = [&](const ImageFour& four) {
    if (result.cut_short && random.uniform() >= chance) return;
    Found one{four.ids, four};
    std::sort(one.sorted.begin(), one.sorted.end());
    found.push_back(one);
  };
  for (std::size_t b = 0; b < image.size(); ++b) {
    const std::vector<std::uint16_t>& around = image[b].links;
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          add(four_of(FourShape::kStar, b, around[i], around[j], around[k]));
        }
      }
      const std::size_t c = around[i];
      if (c < b) continue;
      for (const std::uint16_t a : around) {
        for (const std::uint16_t d : image[c].links) {
          if (a != c && d != b && a != d) add(four_of(FourShape::kPath, a, b, c, d));
        }
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const Found& x, const Found& y) {
    return std::tie(x.sorted, x.four.shape, x.four.ids) <
           std::tie(y.sorted, y.four.shape, y.four.ids);
  });
  found.erase(std::unique(found.begin(),
                          found.end(),
                          [](const Found& x, const Found& y) { return x.sorted == y.sorted; }),
              found.end());
  for (const Found& one : found) result.fours.push_back(one.four);
  for (std::size_t i = result.fours.size(); i > 1; --i) {  // Fisher and Yates
    std::swap(result.fours[i - 1], result.fours[random.below(i)]);
  }
  return result;
}

}  // namespace landmarkdb
