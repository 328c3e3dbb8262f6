#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/base/error.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// The BLOBs of the model tables as bytes, all numbers little-endian, and back. `what` begins the
// message of Error{kDataLoss} for bytes of a length that cannot be.

std::vector<std::byte> bytes_of_symmetries(const std::vector<Eigen::Matrix4d>& symmetries);
std::vector<Eigen::Matrix4d> symmetries_from(std::span<const std::byte> bytes,
                                             const std::string& what);

std::vector<std::byte> bytes_of_indices(const std::vector<std::uint32_t>& indices);
std::vector<std::uint32_t> point_list_from(std::span<const std::byte> bytes,
                                           const std::string& what);

// u v n centroid i00 i01 i11: 15 doubles.
std::vector<std::byte> bytes_of_basis(const ModelTriple& triple);
void set_basis(ModelTriple& triple, std::span<const std::byte> bytes, const std::string& what);

// View k is bit k % 8 of byte k / 8.
std::vector<std::byte> bytes_of_views(const ViewMask& views);
ViewMask views_from(std::span<const std::byte> bytes, const std::string& what);

// Bit k: the k-th edge ends in point `idx`.
std::vector<std::byte> edge_mask_of(const MonoModel& model, std::uint32_t idx);

// SHA-256 over the model but its name, and over its triples.
std::string model_digest(const MonoModel& model);
std::string triples_digest(const std::vector<ModelTriple>& triples);
// Over the model's own digest, the version and the params (a line each), and the bytes: an index is
// read as that of this model and of this layout, or not at all.
std::string index_digest(const std::string& model_sha256, const ModelIndexBlob& index);

// Throws Error{code} beginning with `what` unless all indices point into the model, all numbers are
// finite and normals are of unit length: what a Recognizer may rely on.
void validate_model(const MonoModelRecord& record, const std::string& what, ErrorCode code);

}  // namespace landmarkdb
