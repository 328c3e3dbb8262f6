#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

struct SceneRecord;

// What is kept of a scene beside it (engine/retrieval/scene_index.hpp), derived from it: may be
// deleted, and is then made anew.
struct SceneIndexBlob {
  std::int64_t version = 0;        // of the layout
  std::string params{};            // what they were made with, free text
  std::vector<std::byte> codes{};  // what it takes to know the scene among many
  std::vector<std::byte> tails{};  // and what it takes to compare descriptors more closely

  bool is_made_like(const SceneIndexBlob& other) const {
    return version == other.version && params == other.params;
  }
};

// How much of a scene is wanted in memory, the second more than the first.
enum class SceneParts {
  kSurface,  // all but descriptor values
  kWhole,
};

// Where a scene that is not in memory is read from. Thread-safe.
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  // Reads and verifies the very version that the catalogue names. Throws Error{kDataLoss} for one
  // that is damaged or not there any more, Error{kUnavailable} where the file cannot be read now.
  virtual std::shared_ptr<const SceneRecord> load(SceneParts parts,
                                                  const RunContext& context) const = 0;
  // What is stored with it, its digests checked; nothing where there is none that is sound. Without
  // tails they are not read.
  virtual std::optional<SceneIndexBlob> index(bool with_tails, const RunContext& context) const = 0;
};

}  // namespace landmarkdb
