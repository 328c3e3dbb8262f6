#include "store/model_bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "store/sha256.hpp"

namespace landmarkdb {
namespace {

class ByteWriter {
 public:
  void number(std::uint64_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; ++i) {
      bytes_.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xffU));
    }
  }
  void real(double value) { number(std::bit_cast<std::uint64_t>(value), 8); }
  void vector(const Eigen::Vector3d& v) {
    for (Eigen::Index i = 0; i < 3; ++i) real(v[i]);
  }
  void index(std::size_t value) { number(value, 4); }
  void text(const std::string& text) {
    index(text.size());
    for (const char c : text) bytes_.push_back(static_cast<std::byte>(c));
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

std::uint64_t number_at(std::span<const std::byte> bytes, std::size_t at, unsigned count) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < count; ++i) {
    value |= static_cast<std::uint64_t>(bytes[at + i]) << (8 * i);
  }
  return value;
}

double real_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::bit_cast<double>(number_at(bytes, at, 8));
}

void require_length(std::span<const std::byte> bytes,
                    bool good,
                    const std::string& what,
                    const std::string& want) {
  if (good) return;
  throw Error(ErrorCode::kDataLoss,
              what + " has " + std::to_string(bytes.size()) + " bytes, want " + want);
}

constexpr std::size_t kMatrixBytes = 16 * sizeof(double);
constexpr std::size_t kBasisBytes = 15 * sizeof(double);

}  // namespace

std::vector<std::byte> bytes_of_symmetries(const std::vector<Eigen::Matrix4d>& symmetries) {
  ByteWriter writer;
  for (const Eigen::Matrix4d& T : symmetries) {
    for (Eigen::Index row = 0; row < 4; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) writer.real(T(row, column));
    }
  }
  return writer.take();
}

std::vector<Eigen::Matrix4d> symmetries_from(std::span<const std::byte> bytes,
                                             const std::string& what) {
  require_length(
      bytes, !bytes.empty() && bytes.size() % kMatrixBytes == 0, what + ": symmetries", "n * 128");
  std::vector<Eigen::Matrix4d> symmetries(bytes.size() / kMatrixBytes);
  for (std::size_t i = 0; i < symmetries.size(); ++i) {
    for (std::size_t k = 0; k < 16; ++k) {
      symmetries[i](static_cast<Eigen::Index>(k / 4), static_cast<Eigen::Index>(k % 4)) =
          real_at(bytes, i * kMatrixBytes + k * sizeof(double));
    }
  }
  return symmetries;
}

std::vector<std::byte> bytes_of_indices(const std::vector<std::uint32_t>& indices) {
  ByteWriter writer;
  for (const std::uint32_t index : indices) writer.index(index);
  return writer.take();
}

std::vector<std::uint32_t> point_list_from(std::span<const std::byte> bytes,
                                           const std::string& what) {
  require_length(bytes, bytes.size() >= 12 && bytes.size() % 4 == 0, what, "n * 4, n >= 3");
  std::vector<std::uint32_t> indices(bytes.size() / 4);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = static_cast<std::uint32_t>(number_at(bytes, 4 * i, 4));
  }
  return indices;
}

std::vector<std::byte> bytes_of_basis(const ModelTriple& triple) {
  ByteWriter writer;
  for (const Eigen::Vector3d& v : {triple.u, triple.v, triple.n, triple.centroid}) writer.vector(v);
  for (const double value : triple.inverse) writer.real(value);
  return writer.take();
}

void set_basis(ModelTriple& triple, std::span<const std::byte> bytes, const std::string& what) {
  require_length(bytes, bytes.size() == kBasisBytes, what + ": basis", "120");
  std::size_t at = 0;
  for (Eigen::Vector3d* v : {&triple.u, &triple.v, &triple.n, &triple.centroid}) {
    for (Eigen::Index i = 0; i < 3; ++i, at += sizeof(double)) (*v)[i] = real_at(bytes, at);
  }
  for (double& value : triple.inverse) {
    value = real_at(bytes, at);
    at += sizeof(double);
  }
}

std::vector<std::byte> bytes_of_views(const ViewMask& views) {
  std::vector<std::byte> bytes(kModelViews / 8, std::byte{0});
  for (std::size_t k = 0; k < kModelViews; ++k) {
    if (views.test(k)) bytes[k / 8] |= static_cast<std::byte>(1U << (k % 8));
  }
  return bytes;
}

ViewMask views_from(std::span<const std::byte> bytes, const std::string& what) {
  require_length(bytes, bytes.size() == kModelViews / 8, what + ": views", "32");
  ViewMask views;
  for (std::size_t k = 0; k < kModelViews; ++k) {
    views.set(k, (bytes[k / 8] & static_cast<std::byte>(1U << (k % 8))) != std::byte{0});
  }
  return views;
}

std::vector<std::byte> edge_mask_of(const MonoModel& model, std::uint32_t idx) {
  std::vector<std::byte> mask((model.edges.size() + 7) / 8, std::byte{0});
  for (std::size_t k = 0; k < model.edges.size(); ++k) {
    if (model.edges[k][0] == idx || model.edges[k][1] == idx) {
      mask[k / 8] |= static_cast<std::byte>(1U << (k % 8));
    }
  }
  return mask;
}

std::string model_digest(const MonoModel& model) {
  ByteWriter writer;
  writer.text(model.source);
  writer.real(model.unit_scale);
  writer.real(model.diameter_m);
  writer.text(model.symmetry_class);
  writer.index(model.points.size());
  for (const ModelFeature& p : model.points) {
    writer.number(static_cast<std::uint64_t>(p.type), 1);
    writer.vector(p.xyz);
    writer.number(p.normal ? 1 : 0, 1);
    if (p.normal) writer.vector(*p.normal);
    writer.number(static_cast<std::uint32_t>(p.part), 4);
  }
  writer.index(model.edges.size());
  for (const auto& [a, b] : model.edges) {
    writer.index(a);
    writer.index(b);
  }
  writer.index(model.faces.size());
  for (const auto& face : model.faces) {
    writer.index(face.size());
    for (const std::uint32_t corner : face) writer.index(corner);
  }
  writer.index(model.circles.size());
  for (const ModelCircle& circle : model.circles) {
    writer.vector(circle.center);
    writer.vector(circle.normal);
    writer.real(circle.radius_m);
  }
  std::vector<std::byte> bytes = writer.take();
  const std::vector<std::byte> symmetries = bytes_of_symmetries(model.symmetries);
  bytes.insert(bytes.end(), symmetries.begin(), symmetries.end());
  return sha256_of(bytes);
}

std::string triples_digest(const std::vector<ModelTriple>& triples) {
  Sha256 digest;
  for (const ModelTriple& triple : triples) {
    ByteWriter writer;
    for (const std::uint32_t point : triple.points) writer.index(point);
    writer.number(triple.type_signature, 4);
    writer.number(triple.links, 1);
    writer.number(static_cast<std::uint32_t>(triple.face), 4);
    for (const double length : triple.lengths_m) writer.real(length);
    writer.real(triple.min_sin);
    digest.update(writer.take());
    digest.update(bytes_of_basis(triple));
    digest.update(bytes_of_views(triple.views));
  }
  return digest.finish();
}

std::string index_digest(const std::string& model_sha256, const ModelIndexBlob& index) {
  Sha256 digest;
  const std::string head =
      model_sha256 + "\n" + std::to_string(index.version) + "\n" + index.params + "\n";
  digest.update(std::as_bytes(std::span(head)));
  digest.update(index.quads);
  return digest.finish();
}

void validate_model(const MonoModelRecord& record, const std::string& what, ErrorCode code) {
  const MonoModel& model = record.model;
  const auto require = [&](bool good, const std::string& sentence) {
    if (!good) throw Error(code, what + ": " + sentence);
  };
  const auto is_unit = [](const Eigen::Vector3d& v) {
    constexpr double kTolerance = 1e-6;
    return v.allFinite() && std::abs(v.norm() - 1.0) < kTolerance;
  };
  const auto is_point = [&](std::uint32_t i) { return i < model.points.size(); };
  require(!model.points.empty(), "it has no points");
  require(std::isfinite(model.diameter_m) && model.diameter_m > 0.0, "its diameter is not above 0");
  require(std::isfinite(model.unit_scale) && model.unit_scale > 0.0, "its scale is not above 0");
  require(!model.symmetries.empty(), "it has no symmetries, want the identity");
  for (const Eigen::Matrix4d& T : model.symmetries) {
    require(T.allFinite(), "a symmetry is not finite");
  }
  for (const ModelFeature& p : model.points) {
    require(p.xyz.allFinite() && (!p.normal || is_unit(*p.normal)),
            "a point is not finite or its normal no unit vector");
    const bool circle = p.type == FeatureType::kConicCentre;
    const bool face = p.type == FeatureType::kCentroid;
    const std::size_t parts = circle ? model.circles.size() : face ? model.faces.size() : 0;
    require(p.part >= -1 && (p.part < 0 || static_cast<std::size_t>(p.part) < parts),
            "a point is the centre of a circle or face that is not there");
  }
  for (const auto& [a, b] : model.edges) {
    require(a < b && is_point(b), "an edge names a point that is not there");
  }
  for (const auto& face : model.faces) {
    require(face.size() >= 3 && std::all_of(face.begin(), face.end(), is_point),
            "a face names a point that is not there");
  }
  for (const ModelCircle& circle : model.circles) {
    require(circle.center.allFinite() && is_unit(circle.normal) && std::isfinite(circle.radius_m) &&
                circle.radius_m > 0.0,
            "a circle is not finite, or its normal no unit vector");
  }
  for (const ModelTriple& triple : record.triples) {
    require(std::all_of(triple.points.begin(), triple.points.end(), is_point),
            "a triple names a point that is not there");
    require(triple.face >= -1 && triple.face < static_cast<std::int64_t>(model.faces.size()),
            "a triple names a face that is not there");
  }
}

}  // namespace landmarkdb
