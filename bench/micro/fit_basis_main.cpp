// landmarkdb-fit-basis: writes engine/matching/code_basis_data.cpp, the principal components of
// SHOT over generated places.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "bench/micro/descriptor_data.hpp"
#include "engine/base/error.hpp"
#include "engine/matching/code_basis.hpp"

namespace {

using namespace landmarkdb;

// Places of all six types whose seeds no benchmark uses.
constexpr std::uint64_t kSeed = 5000;
constexpr std::size_t kRows = 240'000;
// One code in a thousand has a component that is cut off: a finer step serves the others more.
constexpr double kCutOff = 0.999;
constexpr std::size_t kLineLength = 92;

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Base64 (RFC 4648), in lines of string literals.
std::string text_of(const std::vector<std::uint8_t>& bytes) {
  static const char* const digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string digits_of_all;
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {
    const unsigned word = static_cast<unsigned>(bytes[i]) << 16U |
                          static_cast<unsigned>(bytes[i + 1]) << 8U | bytes[i + 2];
    for (unsigned shift : {18U, 12U, 6U, 0U}) digits_of_all += digits[word >> shift & 63U];
  }
  std::string text;
  for (std::size_t i = 0; i < digits_of_all.size(); i += kLineLength) {
    text += "\n    \"" + digits_of_all.substr(i, kLineLength) + "\"";
  }
  return text;
}

void write_basis() {
  const bench::DescriptorData data =
      bench::make_descriptor_data({.stored = kRows, .queries = 0, .seed = kSeed}, {});
  const Eigen::Map<const Matrix> rows(data.stored.data(), kRows, kShotLength);
  const Eigen::RowVectorXf mean = rows.colwise().mean();
  const Matrix centred = rows.rowwise() - mean;
  const Eigen::MatrixXd scatter = (centred.transpose() * centred).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scatter);
  // Largest first; each with its largest element positive, so that the signs are no accident.
  Eigen::MatrixXf components(kCodeComponents, kShotLength);
  for (std::size_t d = 0; d < kCodeComponents; ++d) {
    Eigen::VectorXd v = solver.eigenvectors().col(static_cast<Eigen::Index>(kShotLength - 1 - d));
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0.0) v = -v;
    components.row(static_cast<Eigen::Index>(d)) = v.transpose().cast<float>();
  }
  const float scale = 127.0F / components.cwiseAbs().maxCoeff();
  std::vector<std::uint8_t> bytes;
  for (Eigen::Index d = 0; d < components.rows(); ++d) {
    for (Eigen::Index j = 0; j < components.cols(); ++j) {
      components(d, j) = std::round(components(d, j) * scale);
      bytes.push_back(static_cast<std::uint8_t>(static_cast<int>(components(d, j)) + 128));
    }
  }
  while (bytes.size() % 3 != 0) bytes.push_back(0);
  const Matrix sums = kRowSteps * (centred * components.transpose());
  std::vector<float> largest(kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    largest[i] = sums.row(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff();
  }
  std::sort(largest.begin(), largest.end());
  const float cut = largest[static_cast<std::size_t>(kCutOff * static_cast<double>(kRows))];
  const Eigen::VectorXf means = kRowSteps * (components * mean.transpose());

  std::printf("// Written by landmarkdb-fit-basis (%zu rows, seed %llu); do not edit.\n",
              kRows,
              static_cast<unsigned long long>(kSeed));
  std::printf("#include \"engine/matching/code_basis_data.hpp\"\n\nnamespace landmarkdb {\n\n");
  std::printf("const float kCodeStep = %.1fF;\n\n", std::ceil(static_cast<double>(cut) / 127.0));
  std::printf("const std::int32_t kCodeMeans[] = {");
  for (Eigen::Index d = 0; d < means.size(); ++d) {
    std::printf("%s%d,", d % 8 == 0 ? "\n    " : " ", static_cast<int>(std::lround(means[d])));
  }
  std::printf("\n};\n\nconst char kCodeComponentDigits[] =%s;\n\n", text_of(bytes).c_str());
  std::printf("}  // namespace landmarkdb\n");
  std::fprintf(stderr,
               "%zu components hold %.3f of the variance\n",
               kCodeComponents,
               solver.eigenvalues().tail(kCodeComponents).sum() / solver.eigenvalues().sum());
}

}  // namespace

int main() {
  try {
    write_basis();
  } catch (const Error& error) {
    std::fprintf(stderr, "landmarkdb-fit-basis: %s\n", error.what());
    return 1;
  }
  return 0;
}
