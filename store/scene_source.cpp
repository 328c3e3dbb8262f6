#include "store/scene_source.hpp"

#include <mutex>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/types/scene_record.hpp"
#include "store/catalog.hpp"
#include "store/open.hpp"
#include "store/scene_index.hpp"
#include "store/segment_rows.hpp"

namespace landmarkdb {
namespace {

class StoredScene final : public SceneSource {
 public:
  StoredScene(std::string path, VersionRow row) : path_(std::move(path)), row_(std::move(row)) {}

  std::shared_ptr<const SceneRecord> load(SceneParts parts,
                                          const RunContext& context) const override {
    if (parts == SceneParts::kWhole) {
      const std::lock_guard lock(mutex_);
      if (auto held = whole_.lock()) return held;
    }
    const std::unique_ptr<sqlite::Database> database = open();
    const sqlite::Transaction snapshot(*database, sqlite::Transaction::Kind::kRead);
    require_same_segment(*database);
    std::shared_ptr<const SceneRecord> record = load_record(*database, row_, context, parts);
    if (parts == SceneParts::kWhole) {
      const std::lock_guard lock(mutex_);
      whole_ = record;
    }
    return record;
  }

  std::optional<SceneIndexBlob> index(bool with_tails, const RunContext&) const override {
    const std::unique_ptr<sqlite::Database> database = open();
    const sqlite::Transaction snapshot(*database, sqlite::Transaction::Kind::kRead);
    return read_scene_index(*database, row_, with_tails);
  }

 private:
  std::unique_ptr<sqlite::Database> open() const {
    try {
      return open_database(path_, true, {});
    } catch (const Error& error) {
      throw Error(ErrorCode::kUnavailable, row_.what() + " cannot be read: " + error.what());
    }
  }

  void require_same_segment(const sqlite::Database& database) const {
    sqlite::Statement row(database, "SELECT sha256 FROM segment WHERE id = ?");
    row.bind(row_.segment_id);
    if (row.step() && row.text(0) == row_.sha256) return;
    throw Error(ErrorCode::kDataLoss,
                row_.what() + " is not in the database any more; `reload` tells the server so");
  }

  const std::string path_;
  const VersionRow row_;
  mutable std::mutex mutex_;
  mutable std::weak_ptr<const SceneRecord> whole_;  // one copy for all who hold it
};

}  // namespace

std::shared_ptr<const SceneSource> make_scene_source(std::string path, VersionRow row) {
  return std::make_shared<const StoredScene>(std::move(path), std::move(row));
}

}  // namespace landmarkdb
