#include "store/arrays.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <Eigen/Geometry>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

static_assert(std::endian::native == std::endian::little, "segments are written as they lie");
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));

constexpr float kRotationTolerance = 1e-2F;    // far above the rounding of any frame we compute
constexpr float kQuaternionTolerance = 1e-3F;  // far above the rounding of four floats
constexpr float kLargestHalf = 65504.0F;

template <typename Value>
Bytes copy_to_bytes(const std::vector<Value>& values) {
  Bytes bytes(values.size() * sizeof(Value));
  if (!bytes.empty()) {
    std::memcpy(bytes.data(), static_cast<const void*>(values.data()), bytes.size());
  }
  return bytes;
}

template <typename Value>
std::vector<Value> copy_from_bytes(const Bytes& bytes) {
  std::vector<Value> values(bytes.size() / sizeof(Value));
  if (!values.empty()) {
    std::memcpy(static_cast<void*>(values.data()), bytes.data(), values.size() * sizeof(Value));
  }
  return values;
}

bool is_rotation(const Eigen::Matrix3f& R) {
  return (R.transpose() * R - Eigen::Matrix3f::Identity()).cwiseAbs().maxCoeff() <
             kRotationTolerance &&
         R.determinant() > 0.0F;
}

}  // namespace

Bytes bytes_of(const std::vector<Eigen::Vector3f>& vectors) { return copy_to_bytes(vectors); }
Bytes bytes_of(const std::vector<std::uint16_t>& indices) { return copy_to_bytes(indices); }

std::vector<Eigen::Vector3f> vectors_from(const Bytes& bytes) {
  return copy_from_bytes<Eigen::Vector3f>(bytes);
}

std::vector<std::uint16_t> indices_from(const Bytes& bytes) {
  return copy_from_bytes<std::uint16_t>(bytes);
}

Bytes quaternions_of(const std::vector<Eigen::Matrix3f>& rotations, const std::string& what) {
  std::vector<float> values;
  values.reserve(rotations.size() * 4);
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    if (!is_rotation(rotations[i])) {
      throw Error(ErrorCode::kInvalidArgument,
                  what + ": the frame of keypoint " + std::to_string(i) + " is no rotation");
    }
    Eigen::Quaterniond q(rotations[i].cast<double>());
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
      values.push_back(static_cast<float>(value));
    }
  }
  return copy_to_bytes(values);
}

std::vector<Eigen::Matrix3f> frames_from(const Bytes& bytes, const std::string& what) {
  const auto values = copy_from_bytes<float>(bytes);
  std::vector<Eigen::Matrix3f> frames;
  frames.reserve(values.size() / 4);
  for (std::size_t i = 0; i + 3 < values.size(); i += 4) {
    Eigen::Quaterniond q(static_cast<double>(values[i + 3]),
                         static_cast<double>(values[i]),
                         static_cast<double>(values[i + 1]),
                         static_cast<double>(values[i + 2]));
    if (!(std::abs(q.norm() - 1.0) < static_cast<double>(kQuaternionTolerance))) {
      throw Error(
          ErrorCode::kDataLoss,
          what + ": the frame of keypoint " + std::to_string(i / 4) + " is no unit quaternion");
    }
    q.normalize();
    frames.emplace_back(q.toRotationMatrix().cast<float>());
  }
  return frames;
}

Bytes halves_of(const std::vector<float>& values, const std::string& what) {
  std::vector<std::uint16_t> halves;
  halves.reserve(values.size());
  for (const float value : values) {
    if (!(std::abs(value) <= kLargestHalf)) {
      throw Error(ErrorCode::kInvalidArgument,
                  what + ": the descriptor value " + std::to_string(value) +
                      " does not fit a 16-bit float");
    }
    halves.push_back(Eigen::half(value).x);
  }
  return copy_to_bytes(halves);
}

std::vector<float> unit_rows_from(const Bytes& bytes, std::size_t row_length) {
  const auto halves = copy_from_bytes<std::uint16_t>(bytes);
  std::vector<float> values(halves.size());
  for (std::size_t begin = 0; begin + row_length <= halves.size(); begin += row_length) {
    double squares = 0.0;
    for (std::size_t i = begin; i < begin + row_length; ++i) {
      values[i] = static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(halves[i]));
      squares += static_cast<double>(values[i]) * static_cast<double>(values[i]);
    }
    if (!(squares > 0.0)) continue;
    const double scale = 1.0 / std::sqrt(squares);
    for (std::size_t i = begin; i < begin + row_length; ++i) {
      values[i] = static_cast<float>(static_cast<double>(values[i]) * scale);
    }
  }
  return values;
}

}  // namespace landmarkdb
