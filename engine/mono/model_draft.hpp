#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/input.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// A model as its file tells it, in metres, before anything is derived or checked.
struct ModelDraft {
  MonoModel model;
  bool edges_listed = false;       // edges are not to be derived
  bool symmetries_listed = false;  // neither are symmetries
  std::vector<std::string> warnings{};
};

// Reads the file that a .cao names in load("..."); empty: such files are refused.
using LoadPart = std::function<ModelDraft(const std::string& name)>;

// The three readers; each checks indices and limits as it goes. Throw Error{kInvalidArgument}.
ModelDraft parse_model_json(const Input& input, const ReadModelOptions& options);
ModelDraft parse_cao(const Input& input, const ReadModelOptions& options, const LoadPart& load);
ModelDraft parse_mesh_model(const Input& input, const ReadModelOptions& options);

// Throws Error{kInvalidArgument} when there are more than `most`: "crate.obj: 700 faces, want at
// most 512".
void require_at_most(const Input& input,
                     std::size_t count,
                     std::size_t most,
                     std::string_view what);

// Throws for a number that is not finite or beyond a million metres.
void require_coordinate(const Input& input, double value, const std::string& what);

}  // namespace landmarkdb
