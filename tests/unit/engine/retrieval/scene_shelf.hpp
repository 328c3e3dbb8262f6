#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::testing {

// A source that gives a record it holds, as one in a file would; may be told that it is damaged.
class SceneShelf final : public SceneSource {
 public:
  explicit SceneShelf(std::shared_ptr<const SceneRecord> whole) : whole_(std::move(whole)) {}

  std::shared_ptr<const SceneRecord> load(SceneParts parts, const RunContext&) const override {
    ++loads;
    if (damaged) throw Error(ErrorCode::kDataLoss, "scene '" + whole_->name + "' is damaged");
    if (parts == SceneParts::kWhole) return whole_;
    auto part = std::make_shared<SceneRecord>(*whole_);
    part->descriptors.values.clear();
    return part;
  }
  std::optional<SceneIndexBlob> index(bool with_tails, const RunContext&) const override {
    std::optional<SceneIndexBlob> read = stored_index;
    if (read && !with_tails) read->tails.clear();
    return read;
  }

  mutable std::atomic<int> loads{0};
  std::atomic<bool> damaged{false};
  std::optional<SceneIndexBlob> stored_index{};

 private:
  std::shared_ptr<const SceneRecord> whole_;
};

// The entry with nothing but its outline in memory, and the shelf it is read from.
inline std::shared_ptr<SceneShelf> put_on_shelf(CatalogEntry& entry) {
  auto shelf = std::make_shared<SceneShelf>(entry.record);
  auto outline = std::make_shared<SceneRecord>(*entry.record);
  entry.points = outline->prepared.size();
  entry.keypoints = outline->descriptors.size();
  outline->prepared.points.clear();
  outline->prepared.normals.clear();
  outline->prepared.viewpoint_index.clear();
  outline->descriptors = {};
  entry.record = std::move(outline);
  entry.source = shelf;
  return shelf;
}

}  // namespace landmarkdb::testing
