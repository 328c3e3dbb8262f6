#include "engine/mono/four_metric.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = FourIndex::kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int8_t Bytes __attribute__((vector_size(kLanes)));

#define LANDMARKDB_KERNEL_BODY "engine/mono/four_metric_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<FourKernel> kSets LANDMARKDB_KERNEL_SETS(mark);

// w^H G w of one four, as the kernels have it.
float size_of(const std::array<const float*, 6>& metric,
              std::size_t at,
              const std::array<float, 6>& products) {
  return metric[0][at] * products[0] + metric[1][at] * products[1] + metric[2][at] * products[2] +
         metric[3][at] * products[3] + metric[4][at] * products[4] + metric[5][at] * products[5];
}

}  // namespace

FourKernel four_kernel(const char* instruction_set) { return kSets.named(instruction_set); }

FourProducts four_products(const std::array<Eigen::Vector2d, 4>& rays) {
  constexpr std::array<std::array<std::size_t, 2>, 6> kElements{
      {{1, 1}, {2, 2}, {3, 3}, {1, 2}, {1, 3}, {2, 3}}};
  FourProducts products;
  for (std::size_t k = 0; k < 6; ++k) {
    const Eigen::Vector2d a = rays[kElements[k][0]] - rays[0];
    const Eigen::Vector2d b = rays[kElements[k][1]] - rays[0];
    const double twice = k < 3 ? 1.0 : 2.0;
    products.real[k] = static_cast<float>(twice * (a.x() * b.x() - a.y() * b.y()));
    products.imaginary[k] = static_cast<float>(twice * (a.x() * b.y() + a.y() * b.x()));
    products.size[k] = static_cast<float>(twice * a.dot(b));
  }
  return products;
}

void test_fours(const FourIndex& index,
                const FourIndex::Group& group,
                const FourProducts& products,
                float tolerance,
                std::vector<FourHit>& hits) {
  static const FourKernel mark = kSets.best();
  constexpr std::size_t kBlock = 1024;
  constexpr std::size_t kAtOnce = sizeof(std::uint64_t);
  static_assert(kBlock % kLanes == 0 && kLanes % kAtOnce == 0);
  std::array<std::uint8_t, kBlock> passes;
  for (std::size_t first = 0; first < group.size; first += kBlock) {
    const std::size_t count = std::min(kBlock, group.size - first);
    std::array<const float*, 6> metric{};
    for (std::size_t k = 0; k < 6; ++k) metric[k] = index.metric(k, group.first + first);
    mark(metric.data(), count, products, tolerance * tolerance, passes.data());
    for (std::size_t at = 0; at < count; at += kAtOnce) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, &passes[at], sizeof eight);
      if constexpr (std::endian::native == std::endian::big) eight = __builtin_bswap64(eight);
      while (eight != 0) {  // a byte of four i + at is 0, or has all its bits set
        const auto i = static_cast<unsigned>(std::countr_zero(eight)) / 8U;
        eight &= ~(std::uint64_t{0xff} << 8U * i);
        hits.push_back({static_cast<std::uint32_t>(group.first + first + at + i),
                        size_of(metric, at + i, products.size)});
      }
    }
  }
}

}  // namespace landmarkdb
