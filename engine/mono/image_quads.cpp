#include "engine/mono/image_quads.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/base/random.hpp"
#include "engine/mono/quad_index.hpp"

namespace landmarkdb {
namespace {

constexpr double kShortest_px = 12.0;  // of AB: below, a pixel of noise is all the code there is

void add_quad(const ImageView& image, const PointFour& four, ImageQuads& result) {
  QuadCode code;
  if (!code_quad({image[four[0]].xy, image[four[1]].xy, image[four[2]].xy, image[four[3]].xy},
                 code)) {
    return;
  }
  ImageQuad quad;
  for (std::size_t k = 0; k < 4; ++k) {
    quad.ids[k] = four[code.order[k]];
    quad.signature = static_cast<std::uint8_t>(
        quad.signature | (static_cast<unsigned>(image[quad.ids[k]].type) << (2 * k)));
  }
  quad.code = code.code;
  const double length = (image[quad.ids[1]].xy - image[quad.ids[0]].xy).norm();
  if (length < kShortest_px) return;
  quad.length_px = static_cast<float>(length);
  result.quads.push_back(quad);
}

void add_quads(const ImageView& image, std::vector<PointFour>& fours, ImageQuads& result) {
  std::sort(fours.begin(), fours.end());
  fours.erase(std::unique(fours.begin(), fours.end()), fours.end());
  for (const PointFour& four : fours) add_quad(image, four, result);
}

// Passes on each of `total` things with the same chance, so that some `most` of them remain.
class Sample {
 public:
  Sample(double total, std::size_t most)
      : chance_(total > static_cast<double>(most) ? static_cast<double>(most) / total : 1.0),
        random_(most) {}
  bool pass() { return chance_ >= 1.0 || random_.uniform() < chance_; }
  bool thins() const { return chance_ < 1.0; }

 private:
  double chance_;
  Random random_;
};

}  // namespace

ImageQuads chained_quads(const ImageView& image, std::size_t most) {
  ImageQuads result;
  double total = 0.0;
  for (std::size_t b = 0; b < image.size(); ++b) {
    const double degree = static_cast<double>(image[b].links.size());
    total += degree * (degree - 1.0) * (degree - 2.0) / 6.0;
    for (const std::uint16_t c : image[b].links) {
      if (c > b) total += (degree - 1.0) * (static_cast<double>(image[c].links.size()) - 1.0);
    }
  }
  Sample sample(total, most);
  result.cut_short = sample.thins();
  std::vector<PointFour> fours;
  for (std::size_t b = 0; b < image.size(); ++b) {
    const std::vector<std::uint16_t>& around = image[b].links;
    for (std::size_t i = 0; i < around.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          if (sample.pass()) add_four(b, around[i], around[j], around[k], fours);
        }
      }
      const std::size_t c = around[i];
      if (c < b) continue;
      for (const std::uint16_t a : around) {
        for (const std::uint16_t d : image[c].links) {
          if (a != c && d != b && sample.pass()) add_four(a, b, c, d, fours);
        }
      }
    }
  }
  add_quads(image, fours, result);
  return result;
}

ImageQuads linked_quads(const ImageView& image, std::size_t most) {
  ImageQuads result;
  std::vector<std::array<std::uint16_t, 2>> links;
  double meeting = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double degree = static_cast<double>(image[i].links.size());
    meeting += 0.5 * degree * (degree - 1.0);
    for (const std::uint16_t other : image[i].links) {
      if (other > i) links.push_back({static_cast<std::uint16_t>(i), other});
    }
  }
  const double n = static_cast<double>(image.size()), m = static_cast<double>(links.size());
  Sample sample(meeting * n + 0.5 * m * m, most);
  result.cut_short = sample.thins();
  std::vector<PointFour> fours;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const std::vector<std::uint16_t>& around = image[i].links;
    for (std::size_t a = 0; a < around.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        for (std::size_t p = 0; p < image.size(); ++p) {
          if (sample.pass()) add_four(i, around[a], around[b], p, fours);
        }
      }
    }
  }
  for (std::size_t a = 0; a < links.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (sample.pass()) add_four(links[a][0], links[a][1], links[b][0], links[b][1], fours);
    }
  }
  std::erase_if(fours, [&](const PointFour& four) {
    const auto linked = [&](std::uint16_t a, std::uint16_t b) { return image.linked(a, b); };
    return std::popcount(link_mask(four, linked)) > 2;
  });
  add_quads(image, fours, result);
  return result;
}

ImageQuads free_quads(const ImageView& image, unsigned types, std::size_t most) {
  ImageQuads result;
  std::vector<std::uint16_t> ids;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (types >> image[i].type & 1U) ids.push_back(static_cast<std::uint16_t>(i));
  }
  // A pair gives 36 fours at most, of which a third is roomy enough.
  const double pairs = 0.5 * static_cast<double>(ids.size()) * static_cast<double>(ids.size());
  Sample sample(12.0 * pairs, most);
  result.cut_short = sample.thins();
  std::vector<std::pair<double, std::uint16_t>> inside;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!sample.pass()) continue;
      const Eigen::Vector2d& A = image[ids[i]].xy;
      const Eigen::Vector2d& B = image[ids[j]].xy;
      const Eigen::Vector2d middle = 0.5 * (A + B);
      const double reach = 0.25 * (A - B).squaredNorm();
      inside.clear();
      for (const std::uint16_t id : ids) {
        if (id == ids[i] || id == ids[j]) continue;
        const double d2 = (image[id].xy - middle).squaredNorm();
        if (d2 <= reach) inside.emplace_back(d2, id);
      }
      const std::size_t kept = std::min(inside.size(), kNearMiddle);
      std::partial_sort(
          inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(kept), inside.end());
      for (std::size_t c = 0; c < kept; ++c) {
        for (std::size_t d = 0; d < c; ++d) {
          add_quad(image, {ids[i], ids[j], inside[c].second, inside[d].second}, result);
        }
      }
    }
  }
  return result;
}

}  // namespace landmarkdb
