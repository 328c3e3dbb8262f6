#include "engine/matching/code_basis.hpp"

#include <cstddef>

#include "engine/matching/code_basis_data.hpp"

namespace landmarkdb {
namespace {

unsigned digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<unsigned>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<unsigned>(c - 'a') + 26U;
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') + 52U;
  return c == '+' ? 62U : 63U;
}

CodeBasis decode() {
  CodeBasis basis;
  basis.step = kCodeStep;
  for (std::size_t d = 0; d < kCodeComponents; ++d) basis.mean[d] = kCodeMeans[d];
  constexpr std::size_t kBytes = kCodeComponents * kShotLength;
  basis.components.reserve(kBytes + 2);
  for (const char* c = kCodeComponentDigits; basis.components.size() < kBytes; c += 4) {
    const unsigned word =
        digit_of(c[0]) << 18U | digit_of(c[1]) << 12U | digit_of(c[2]) << 6U | digit_of(c[3]);
    for (const unsigned shift : {16U, 8U, 0U}) {
      const int element = static_cast<int>(word >> shift & 255U) - 128;
      basis.components.push_back(static_cast<std::int16_t>(element));
    }
  }
  basis.components.resize(kBytes);
  return basis;
}

}  // namespace

const CodeBasis& code_basis() {
  static const CodeBasis basis = decode();
  return basis;
}

}  // namespace landmarkdb
