#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// What a model may hold; checked before anything is built from it. Views, triples and symmetries
// grow with powers of the number of points; the largest of the models seen has 52.
inline constexpr std::size_t kMaxModelPoints = 256;
inline constexpr std::size_t kMaxModelEdges = 1024;
inline constexpr std::size_t kMaxModelFaces = 512;
inline constexpr std::size_t kMaxModelCircles = 128;
inline constexpr std::size_t kMaxModelSymmetries = 120;
inline constexpr std::size_t kMaxMeshVertices =
    200'000;  // of an .obj or .ply before simplification

struct ReadModelOptions {
  std::optional<Units> units{};  // of the file's lengths; none: what it says itself, else metres
};

struct ReadModelResult {
  MonoModel model;                      // metres, derived parts filled in; named after the file
  std::vector<std::string> warnings{};  // sentences: what was changed or looks wrong
};

// Reads a monocular model: JSON, ViSP's CAD text (.cao, version V1), or a polyhedron as an OBJ or
// PLY mesh; the content tells which, the extension where it cannot.
//
// What is derived (derive_model.hpp): edges from faces, a conic_centre for each circle and a
// centroid for each face, faces of solids turned outward, symmetries, their class, the diameter. A
// mesh's coplanar triangles become one face, its edges of less than 20 degrees are no edges, its
// round rims become circles.
//
// Throws Error{kInvalidArgument} that names the file, the thing in it, what was seen and what was
// wanted; what `context.check` throws.
ReadModelResult read_model(const std::filesystem::path& path,
                           const ReadModelOptions& options,
                           const RunContext& context = {});

// The same for a file in memory; `name` is what messages call it.
ReadModelResult parse_model(std::span<const std::byte> bytes,
                            std::string_view name,
                            const ReadModelOptions& options,
                            const RunContext& context = {});

// The model as the JSON that parse_model reads back to the same model: metres, everything listed.
std::string model_to_json(const MonoModel& model);

}  // namespace landmarkdb
