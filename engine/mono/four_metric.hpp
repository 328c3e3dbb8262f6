#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/mono/four_index.hpp"

namespace landmarkdb {

// What the test of orthography needs of an image's four: products of its differences w, by elements
// as FourIndex::metric has them, off-diagonal ones doubled.
struct FourProducts {
  std::array<float, 6> real{}, imaginary{};  // of w_k w_l
  std::array<float, 6> size{};               // of w_k conj(w_l), the real part
};

// `rays` as they lie in a camera turned towards the four.
FourProducts four_products(const std::array<Eigen::Vector2d, 4>& rays);

struct FourHit {
  std::uint32_t model_four = 0;  // in the index
  float size = 0.0F;             // w^H G w
};

// Sets passes[i] to 255 where |w^T G w|^2 of four i is below `bound` times the square of w^H G w,
// else to 0. `metric` has the six elements as FourIndex::metric has them; `count` is a multiple of
// FourIndex::kLanes.
using FourKernel = void (*)(const float* const* metric,
                            std::size_t count,
                            const FourProducts& products,
                            float bound,
                            std::uint8_t* passes);

// The kernel of one instruction set by name, "sse2", "avx2" or "avx512"; null where the machine
// lacks it. All of them give the same bytes.
FourKernel four_kernel(const char* instruction_set);

// Appends the fours of a group whose |w^T G w| is below `tolerance` of w^H G w.
void test_fours(const FourIndex& index,
                const FourIndex::Group& group,
                const FourProducts& products,
                float tolerance,
                std::vector<FourHit>& hits);

}  // namespace landmarkdb
