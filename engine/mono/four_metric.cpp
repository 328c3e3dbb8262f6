#include "engine/mono/four_metric.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = FourIndex::kLanes;
using Lanes = std::array<float, kLanes>;

// sum of G's elements times the products', for kLanes fours.
[[gnu::always_inline]] inline Lanes weighed(const std::array<const float*, 6>& metric,
                                            std::size_t at,
                                            const std::array<float, 6>& products) {
  Lanes sum;
  for (std::size_t i = 0; i < kLanes; ++i) {
    sum[i] = metric[0][at + i] * products[0] + metric[1][at + i] * products[1] +
             metric[2][at + i] * products[2] + metric[3][at + i] * products[3] +
             metric[4][at + i] * products[4] + metric[5][at + i] * products[5];
  }
  return sum;
}

[[gnu::always_inline]] inline void test_all(const FourIndex& index,
                                            const FourIndex::Group& group,
                                            const FourProducts& products,
                                            float tolerance,
                                            std::vector<FourHit>& hits) {
  const float bound = tolerance * tolerance;
  std::array<const float*, 6> metric{};
  for (std::size_t k = 0; k < 6; ++k) metric[k] = index.metric(k, group.first);
  for (std::size_t at = 0; at < group.size; at += kLanes) {
    const Lanes real = weighed(metric, at, products.real);
    const Lanes imaginary = weighed(metric, at, products.imaginary);
    const Lanes size = weighed(metric, at, products.size);
    std::array<std::int32_t, kLanes> passes;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float off = real[i] * real[i] + imaginary[i] * imaginary[i];
      passes[i] = off < bound * size[i] * size[i] ? 1 : 0;
      any += passes[i];
    }
    if (any == 0) continue;
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (passes[i] != 0)
        hits.push_back({static_cast<std::uint32_t>(group.first + at + i), size[i]});
    }
  }
}

// The same sums in the same order, none of them fused: the same answer on every machine.
[[gnu::target("avx2")]] void test_avx2(const FourIndex& index,
                                       const FourIndex::Group& group,
                                       const FourProducts& products,
                                       float tolerance,
                                       std::vector<FourHit>& hits) {
  test_all(index, group, products, tolerance, hits);
}

void test_plain(const FourIndex& index,
                const FourIndex::Group& group,
                const FourProducts& products,
                float tolerance,
                std::vector<FourHit>& hits) {
  test_all(index, group, products, tolerance, hits);
}

}  // namespace

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
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  (has_avx2 ? test_avx2 : test_plain)(index, group, products, tolerance, hits);
}

}  // namespace landmarkdb
