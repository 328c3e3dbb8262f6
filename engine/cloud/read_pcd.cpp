#include "engine/cloud/read_pcd.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/cloud/byte_window.hpp"
#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/lzf.hpp"
#include "engine/cloud/pcd_header.hpp"

namespace landmarkdb {
namespace {

using Triple = std::array<const PcdField*, 3>;

struct Roles {
  Triple position{}, normal{}, colour{};
  const PcdField* packed_colour = nullptr;  // 0xAARRGGBB in the bits of one number
};

bool complete(const Triple& fields) {
  return std::find(fields.begin(), fields.end(), nullptr) == fields.end();
}

Roles find_roles(const Input& input, const PcdHeader& header) {
  static constexpr std::array<std::string_view, 3> kPosition{"x", "y", "z"};
  static constexpr std::array<std::string_view, 3> kNormal{"normal_x", "normal_y", "normal_z"};
  static constexpr std::array<std::string_view, 3> kColour{"r", "g", "b"};
  Roles roles;
  for (const PcdField& field : header.fields) {
    if (field.count == 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (field.name == kPosition[axis]) roles.position[axis] = &field;
      if (field.name == kNormal[axis]) roles.normal[axis] = &field;
      if (field.name == kColour[axis]) roles.colour[axis] = &field;
    }
    const bool packed = field.name == "rgb" || field.name == "rgba";
    if (packed && scalar_size(field.type) == 4) roles.packed_colour = &field;
  }
  if (!complete(roles.position)) refuse(input, "PCD header: no x, y, z among the FIELDS");
  return roles;
}

// Gives a field's first value, point after point, whatever the kind of data.
class PointReader {
 public:
  PointReader(const Input& input, const PcdHeader& header)
      : input_(input), header_(header), window_(input, header.body) {
    if (header.data == PcdData::kAscii) row_.resize(header.record_values);
    if (header.data == PcdData::kCompressed) unpack();
  }

  // Steps to point `i`; called once for each, in order.
  void go_to(std::uint64_t i) {
    point_ = static_cast<std::size_t>(i);
    switch (header_.data) {
      case PcdData::kAscii:
        return read_row(i);
      case PcdData::kBinary:
        return take_record(i);
      case PcdData::kCompressed:
        return;
    }
  }

  double value(const PcdField& field) const {
    switch (header_.data) {
      case PcdData::kAscii:
        return row_[field.column];
      case PcdData::kBinary:
        return load_scalar(record_ + field.offset, field.type, false);
      case PcdData::kCompressed:  // field after field, each for all points
        return load_scalar(unpacked_.get() +
                               field.offset * static_cast<std::size_t>(header_.points) +
                               point_ * field.bytes(),
                           field.type,
                           false);
    }
    return 0.0;
  }

 private:
  [[noreturn]] void refuse_end(std::uint64_t i) const {
    refuse(input_,
           "PCD data ends at point " + std::to_string(i) + " of " + std::to_string(header_.points));
  }

  void take_record(std::uint64_t i) {
    const std::span<const std::byte> bytes = window_.ahead(header_.record_bytes);
    if (bytes.size() < header_.record_bytes) refuse_end(i);
    record_ = bytes.data();
    window_.skip(header_.record_bytes);
  }

  void read_row(std::uint64_t i) {
    for (double& value : row_) {
      const std::string_view word = take_word(window_);
      if (word.empty()) refuse_end(i);
      const std::optional<double> number = parse_number(word);
      if (!number) {
        refuse(
            input_,
            "PCD data: point " + std::to_string(i) + " has " + in_quotes(word) + ", want a number");
      }
      value = *number;
    }
  }

  void unpack() {
    const std::uint64_t left = window_.left();
    constexpr std::size_t kSizes = 8;  // packed and unpacked size, 32 bits each
    if (left < kSizes) refuse(input_, "PCD data: the compressed block is cut off");
    const std::byte* at = window_.ahead(kSizes).data();
    const auto packed = static_cast<std::size_t>(load_scalar(at, ScalarType::kUint32, false));
    const auto size = static_cast<std::size_t>(load_scalar(at + 4, ScalarType::kUint32, false));
    if (packed > left - kSizes) {
      refuse(input_,
             "PCD data: a compressed block of " + std::to_string(packed) + " bytes, but only " +
                 std::to_string(left - kSizes) + " follow (truncated file?)");
    }
    const std::size_t want = static_cast<std::size_t>(header_.points) * header_.record_bytes;
    if (size != want || size / kLzfMostPerByte > packed) {
      refuse(input_,
             "PCD data: a compressed block of " + std::to_string(packed) +
                 " bytes that unfolds to " + std::to_string(size) + ", want " +
                 std::to_string(want));
    }
    unpacked_ = std::make_unique_for_overwrite<std::byte[]>(size);
    const std::span<const std::byte> body = window_.ahead(kSizes + packed);
    if (body.size() < kSizes + packed ||
        !lzf_decompress(body.subspan(kSizes, packed), {unpacked_.get(), size})) {
      refuse(input_, "PCD data: the compressed block is damaged");
    }
  }

  const Input& input_;
  const PcdHeader& header_;
  ByteWindow window_;
  std::vector<double> row_;
  const std::byte* record_ = nullptr;
  std::unique_ptr<std::byte[]> unpacked_;
  std::size_t point_ = 0;
};

Eigen::Vector3d take(const PointReader& reader, const Triple& fields) {
  return {reader.value(*fields[0]), reader.value(*fields[1]), reader.value(*fields[2])};
}

// A float field carries the colour in its bits, an integer field as a number.
std::array<std::uint8_t, 3> unpack_colour(double value, ScalarType type) {
  std::uint32_t bits = 0;
  if (type == ScalarType::kFloat32) {
    bits = std::bit_cast<std::uint32_t>(to_float(value));
  } else if (value > -0x1p31 && value < 0x1p32) {  // false for NaN
    bits = static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
  }
  return {static_cast<std::uint8_t>((bits >> 16U) & 255U),
          static_cast<std::uint8_t>((bits >> 8U) & 255U),
          static_cast<std::uint8_t>(bits & 255U)};
}

std::uint8_t to_channel(double value) {
  return value > 0.0 ? static_cast<std::uint8_t>(std::min(value + 0.5, 255.0)) : std::uint8_t{0};
}

std::array<std::uint8_t, 3> take_colour(const PointReader& reader, const Roles& roles) {
  if (roles.packed_colour != nullptr) {
    return unpack_colour(reader.value(*roles.packed_colour), roles.packed_colour->type);
  }
  return {to_channel(reader.value(*roles.colour[0])),
          to_channel(reader.value(*roles.colour[1])),
          to_channel(reader.value(*roles.colour[2]))};
}

}  // namespace

void parse_pcd(const Input& input, const ReadOptions& options, const CloudSink& sink) {
  const PcdHeader header = parse_pcd_header(input, options.max_points);
  if (header.points == 0) refuse(input, "PCD header: no points");
  const Roles roles = find_roles(input, header);
  const bool normals = complete(roles.normal);
  const bool colours = roles.packed_colour != nullptr || complete(roles.colour);
  // Of what says nothing else only a picture (rows and columns) was surely taken from its zero.
  const bool organised = header.height > 1;
  const bool known = organised || header.viewpoint;
  const Eigen::Vector3d viewpoint = header.viewpoint.value_or(Eigen::Vector3d::Zero());
  const std::span<const Eigen::Vector3d> viewpoints(&viewpoint, known ? 1 : 0);
  PointReader reader(input, header);
  CloudBuilder builder(metres_per(options.units));
  builder.hand_to(sink, viewpoints);
  builder.reserve(static_cast<std::size_t>(header.points), normals, colours);
  const std::uint64_t bytes_each = input.size() / header.points;  // for the progress
  for (std::uint64_t i = 0; i < header.points; ++i) {
    input.tick(i, i * bytes_each);
    reader.go_to(i);
    builder.add_point(take(reader, roles.position));
    if (normals) builder.add_normal(take(reader, roles.normal));
    if (colours) builder.add_colour(take_colour(reader, roles));
  }
  PointCloud last = builder.finish();
  if (organised && !builder.in_blocks()) {
    last.width = header.width;
    last.height = header.height;
  }
  sink.take(std::move(last));
}

}  // namespace landmarkdb
