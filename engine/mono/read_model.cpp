#include "engine/mono/read_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/cloud/text_lines.hpp"
#include "engine/mono/derive_model.hpp"
#include "engine/mono/model_draft.hpp"

namespace landmarkdb {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{64} << 20U;
constexpr double kFarthest_m = 1e6;

enum class ModelFormat { kJson, kCao, kMesh };

std::string extension_of(std::string_view name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

// The first word that is in no comment.
std::string_view first_word(std::string_view text) {
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view word = take_word(line);
    if (!word.empty() && word.front() != '#') return word;
  }
  return {};
}

ModelFormat recognise(const Input& input) {
  const std::string_view text = input.text();
  if (text.empty()) refuse(input, "is empty, want a model: JSON, .cao, .obj or .ply");
  const std::string_view word = first_word(text);
  const std::string extension = extension_of(input.name);
  if (!word.empty() && word.front() == '{') return ModelFormat::kJson;
  if (word.starts_with("V1") || extension == ".cao") return ModelFormat::kCao;
  if (text.starts_with("ply") || extension == ".obj" || extension == ".ply") {
    return ModelFormat::kMesh;
  }
  if (extension == ".json") return ModelFormat::kJson;
  for (const std::string_view obj : {"v", "vn", "vt", "f", "o", "g", "mtllib"}) {
    if (word == obj) return ModelFormat::kMesh;
  }
  refuse(input,
         "starts with " + in_quotes(text) +
             ", which is no model; want JSON, ViSP's .cao, or an .obj or .ply polyhedron");
}

ModelDraft read_draft(const Input& input, const ReadModelOptions& options, const LoadPart& load) {
  switch (recognise(input)) {
    case ModelFormat::kJson:
      return parse_model_json(input, options);
    case ModelFormat::kCao:
      return parse_cao(input, options, load);
    case ModelFormat::kMesh:
      return parse_mesh_model(input, options);
  }
  refuse(input, "is in no format that can be read");
}

// The parts of a .cao lie in its folder or below, and load no more than kDeepest levels.
LoadPart parts_beside(const std::filesystem::path& path,
                      const ReadModelOptions& options,
                      const RunContext& context,
                      int depth) {
  return [path, &options, &context, depth](const std::string& name) {
    constexpr int kDeepest = 4;
    const std::filesystem::path part(name);
    const bool outside =
        part.is_absolute() ||
        std::any_of(part.begin(), part.end(), [](const auto& p) { return p == ".."; });
    if (outside || depth >= kDeepest) {
      throw Error(ErrorCode::kInvalidArgument,
                  path.string() + ": loads " + in_quotes(name) +
                      (outside ? ", want a file in its own folder or below"
                               : ", which loads further files, " + std::to_string(kDeepest) +
                                     " levels deep"));
    }
    const std::filesystem::path full = path.parent_path() / part;
    const std::string label = full.string();
    const FileBytes file = read_whole_file(full, kMaxFileBytes, context);
    const Input input{file.span(), label, &context};
    return parse_cao(input, options, parts_beside(full, options, context, depth + 1));
  };
}

ReadModelResult parse(std::span<const std::byte> bytes,
                      std::string_view name,
                      const ReadModelOptions& options,
                      const LoadPart& load,
                      const RunContext& context) {
  const Input input{bytes, name, &context};
  try {
    ModelDraft draft = read_draft(input, options, load);
    const std::filesystem::path file(name);
    draft.model.source = file.filename().string();
    if (draft.model.name.empty()) draft.model.name = file.stem().string();
    derive_model(input, draft, context);
    return {std::move(draft.model), std::move(draft.warnings)};
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kResourceExhausted, std::string(name) + ": not enough memory for it");
  }
}

}  // namespace

void require_at_most(const Input& input,
                     std::size_t count,
                     std::size_t most,
                     std::string_view what) {
  if (count <= most) return;
  refuse(
      input,
      std::to_string(count) + " " + std::string(what) + ", want at most " + std::to_string(most));
}

void require_coordinate(const Input& input, double value, const std::string& what) {
  if (std::isfinite(value) && std::abs(value) <= kFarthest_m) return;
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  refuse(input,
         what + " has the coordinate " + text + " m, want finite numbers within a million metres");
}

ReadModelResult parse_model(std::span<const std::byte> bytes,
                            std::string_view name,
                            const ReadModelOptions& options,
                            const RunContext& context) {
  return parse(bytes, name, options, {}, context);
}

ReadModelResult read_model(const std::filesystem::path& path,
                           const ReadModelOptions& options,
                           const RunContext& context) {
  const FileBytes file = read_whole_file(path, kMaxFileBytes, context);
  return parse(
      file.span(), path.string(), options, parts_beside(path, options, context, 0), context);
}

}  // namespace landmarkdb
