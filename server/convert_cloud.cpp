#include "server/convert_cloud.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include <zstd.h>
#include <zstd_errors.h>

#include "engine/base/error.hpp"
#include "server/check_field.hpp"

namespace landmarkdb {

namespace {

static_assert(std::endian::native == std::endian::little, "points are copied as they lie");

constexpr std::size_t kFloatPointBytes = 12;
constexpr std::size_t kInt16PointBytes = 6;
constexpr std::int16_t kInvalidInt16 = std::numeric_limits<std::int16_t>::min();
// Decompressed bytes are turned into points this many at a time; a multiple of 12 and of 6.
constexpr std::size_t kChunkBytes = std::size_t{12} * 64 * 1024;
// Coordinates past this (m) are no place on Earth: georeferenced grids stay below 1e8.
constexpr double kMaxCoordinate_m = 1e9;

std::size_t point_bytes(const v1::Cloud& cloud, const std::string& field) {
  switch (cloud.encoding()) {
    case v1::POINT_ENCODING_FLOAT32:
      return kFloatPointBytes;
    case v1::POINT_ENCODING_INT16:
      return kInt16PointBytes;
    default:
      refuse(field + ".encoding",
             "is " + std::to_string(cloud.encoding()) + ", want FLOAT32 (1) or INT16 (2)");
  }
}

// How many points there will be, checked as far as the message alone allows.
std::uint64_t checked_count(const v1::Cloud& cloud,
                            std::size_t bytes_a_point,
                            const PointAllowance& allowance,
                            const std::string& field) {
  std::uint64_t count = cloud.points();
  if (!cloud.zstd()) {
    const std::uint64_t bytes = cloud.xyz().size();
    if (bytes % bytes_a_point != 0) {
      refuse(field + ".xyz",
             "has " + std::to_string(bytes) + " bytes, want a multiple of " +
                 std::to_string(bytes_a_point));
    }
    if (count != 0 && count != bytes / bytes_a_point) {
      refuse(field + ".points",
             "says " + std::to_string(count) + ", the bytes hold " +
                 std::to_string(bytes / bytes_a_point));
    }
    count = bytes / bytes_a_point;
  }
  if (count == 0) refuse(field + ".points", "the cloud has no points");
  if (count > allowance.points) {
    throw Error(ErrorCode::kResourceExhausted,
                field + ": has " + std::to_string(count) + " points, the request may hold " +
                    std::to_string(allowance.points) + " more",
                field + ".points");
  }
  const std::uint64_t pixels = std::uint64_t{cloud.width()} * cloud.height();
  if ((cloud.width() != 0 || cloud.height() != 0) && pixels != count) {
    refuse(field + ".width",
           std::to_string(cloud.width()) + " x " + std::to_string(cloud.height()) + " is not the " +
               std::to_string(count) + " points there are");
  }
  return count;
}

// Turns raw bytes of whole points into points at the end of a cloud.
class PointDecoder {
 public:
  PointDecoder(const v1::Cloud& cloud, const std::string& field)
      : int16_(cloud.encoding() == v1::POINT_ENCODING_INT16), scale_m_(cloud.scale_m()) {
    if (!int16_) return;
    if (!std::isfinite(scale_m_) || scale_m_ <= 0.0 || scale_m_ > kMaxCoordinate_m) {
      refuse(field + ".scale_m", "is " + std::to_string(scale_m_) + ", want metres above 0");
    }
    if (cloud.has_offset_m()) offset_m_ = from_proto(cloud.offset_m(), field + ".offset_m");
  }

  void append(std::string_view bytes, std::vector<Eigen::Vector3f>& points) const {
    if (int16_) {
      append_int16(bytes, points);
      return;
    }
    static_assert(sizeof(Eigen::Vector3f) == kFloatPointBytes);
    const std::size_t before = points.size();
    points.resize(before + bytes.size() / kFloatPointBytes);
    std::memcpy(points[before].data(), bytes.data(), bytes.size());
  }

 private:
  void append_int16(std::string_view bytes, std::vector<Eigen::Vector3f>& points) const {
    for (std::size_t at = 0; at < bytes.size(); at += kInt16PointBytes) {
      std::array<std::int16_t, 3> raw{};
      std::memcpy(raw.data(), bytes.data() + at, kInt16PointBytes);
      if (std::find(raw.begin(), raw.end(), kInvalidInt16) != raw.end()) {
        points.emplace_back(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
        continue;
      }
      const Eigen::Vector3d value(raw[0], raw[1], raw[2]);
      points.emplace_back((offset_m_ + scale_m_ * value).cast<float>());
    }
  }

  bool int16_;
  double scale_m_;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
};

// The bytes of the decoded points, held until the allowance goes.
void take_memory(std::uint64_t count, PointAllowance& allowance, const std::string& field) {
  if (allowance.memory == nullptr) return;
  const std::uint64_t bytes = count * sizeof(Eigen::Vector3f);
  MemoryBudget::Lease lease = allowance.memory->reserve(bytes);
  if (!lease) {
    throw Error(ErrorCode::kResourceExhausted,
                field + ": its " + std::to_string(count) + " points take " + std::to_string(bytes) +
                    " bytes, the server has " + std::to_string(allowance.memory->left()) +
                    " left of its limit of " + std::to_string(allowance.memory->bytes()) +
                    "; try again later",
                field);
  }
  allowance.held.push_back(std::move(lease));
}

[[noreturn]] void refuse_size(const std::string& field,
                              std::uint64_t wanted,
                              std::uint64_t bytes,
                              std::uint64_t count) {
  const std::string points = "the " + std::to_string(count) + " points";
  refuse(field + ".xyz",
         bytes > wanted
             ? "decompresses to more than " + points
             : "decompresses to " + std::to_string(wanted - bytes) + " bytes less than " + points);
}

// Most compressors write the size of what is inside before it: a frame that lies is not begun.
void check_frame_size(const v1::Cloud& cloud,
                      std::uint64_t wanted,
                      std::uint64_t count,
                      const std::string& field) {
  const unsigned long long size = ZSTD_getFrameContentSize(cloud.xyz().data(), cloud.xyz().size());
  if (size == ZSTD_CONTENTSIZE_ERROR) refuse(field + ".xyz", "is no zstd frame");
  if (size != ZSTD_CONTENTSIZE_UNKNOWN && size != wanted) {
    refuse_size(field, wanted, size, count);
  }
}

[[noreturn]] void refuse_frame(std::size_t code, const std::string& field) {
  if (ZSTD_getErrorCode(code) == ZSTD_error_frameParameter_windowTooLarge) {
    throw Error(ErrorCode::kResourceExhausted,
                field + ".xyz: the zstd frame asks for a larger window than the limit of " +
                    std::to_string(1U << kMaxZstdWindowLog) +
                    " bytes: compress at level 19 or below, without long matches",
                field + ".xyz");
  }
  refuse(field + ".xyz", std::string("is no zstd frame: ") + ZSTD_getErrorName(code));
}

struct FreeDecompressor {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

// Decompresses exactly one zstd frame of `count` points. Stops as soon as it yields more.
void decompress_points(const v1::Cloud& cloud,
                       std::size_t bytes_a_point,
                       std::uint64_t count,
                       const PointDecoder& decoder,
                       const std::string& field,
                       std::vector<Eigen::Vector3f>& points) {
  const std::unique_ptr<ZSTD_DCtx, FreeDecompressor> context(ZSTD_createDCtx());
  if (!context) throw Error(ErrorCode::kResourceExhausted, field + ": no memory to decompress");

  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kMaxZstdWindowLog);

  const std::uint64_t wanted = count * bytes_a_point;
  check_frame_size(cloud, wanted, count, field);
  std::uint64_t yielded = 0;
  points.reserve(count);
  std::vector<char> chunk(kChunkBytes);
  ZSTD_inBuffer in{cloud.xyz().data(), cloud.xyz().size(), 0};
  ZSTD_outBuffer out{chunk.data(), chunk.size(), 0};
  for (bool done = false; !done;) {
    const std::size_t in_before = in.pos;
    const std::size_t out_before = out.pos;
    const std::size_t hint = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(hint) != 0) refuse_frame(hint, field);
    done = hint == 0;
    if (!done && in.pos == in_before && out.pos == out_before) {
      refuse(field + ".xyz", "the zstd frame is cut off");
    }
    if (out.pos < out.size && !done) continue;
    yielded += out.pos;
    if (yielded > wanted) refuse_size(field, wanted, yielded, count);
    const std::size_t whole = out.pos - out.pos % bytes_a_point;
    if (whole > 0) decoder.append(std::string_view(chunk.data(), whole), points);
    out.pos = 0;
  }
  if (yielded != wanted) refuse_size(field, wanted, yielded, count);
  if (in.pos != in.size) refuse(field + ".xyz", "has bytes after the zstd frame");
}

}  // namespace

Eigen::Vector3d from_proto(const v1::Vector3& vector, const std::string& field) {
  const Eigen::Vector3d value(vector.x(), vector.y(), vector.z());
  if (!value.allFinite() || value.cwiseAbs().maxCoeff() > kMaxCoordinate_m) {
    refuse(field, "want three finite numbers below 1e9");
  }
  return value;
}

v1::Vector3 to_proto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

PointCloud from_proto(const v1::Cloud& cloud, PointAllowance& allowance, const std::string& field) {
  const std::size_t bytes_a_point = point_bytes(cloud, field);
  const std::uint64_t count = checked_count(cloud, bytes_a_point, allowance, field);
  const PointDecoder decoder(cloud, field);
  take_memory(count, allowance, field);

  PointCloud result;
  if (cloud.has_viewpoint()) {
    result.viewpoints.push_back(from_proto(cloud.viewpoint(), field + ".viewpoint").cast<float>());
  }
  if (cloud.has_origin_m()) result.origin = from_proto(cloud.origin_m(), field + ".origin_m");
  if (cloud.zstd()) {
    decompress_points(cloud, bytes_a_point, count, decoder, field, result.points);
  } else {
    result.points.reserve(count);
    decoder.append(cloud.xyz(), result.points);
  }
  result.width = cloud.width();
  result.height = cloud.height();
  allowance.points -= count;
  return result;
}

}  // namespace landmarkdb
