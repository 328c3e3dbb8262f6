#include "store/catalog.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/error.hpp"
#include "store/scene_source.hpp"
#include "store/segment_rows.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Transaction;

const CatalogEntry* find_entry(const Catalog* catalog, const VersionRow& row) {
  if (catalog == nullptr) return nullptr;
  for (const CatalogEntry& entry : catalog->entries) {
    // The digest tells the same version from one of another file that took this one's place.
    if (entry.scene_id == row.scene_id && entry.version == row.version && entry.record &&
        entry.record->name == row.scene && !row.sha256.empty() && entry.sha256 == row.sha256) {
      return &entry;
    }
  }
  return nullptr;
}

std::uint64_t rows_of(const Manifest& manifest, std::string_view array) {
  for (const ArrayInfo& info : manifest.arrays) {
    if (info.name == array && !info.shape.empty()) return info.shape[0];
  }
  return 0;
}

// Memory is taken by what a manifest says before its arrays are read.
void require_room(const Database& database, const Manifest& manifest, const std::string& what) {
  const auto pages = static_cast<std::uint64_t>(database.integer("PRAGMA page_count"));
  const std::uint64_t room =
      pages * static_cast<std::uint64_t>(database.integer("PRAGMA page_size"));
  std::uint64_t left = room;
  for (const ArrayInfo& info : manifest.arrays) {
    if (info.bytes > left) {
      throw Error(ErrorCode::kDataLoss,
                  what + ": its manifest says more bytes than the database of " +
                      std::to_string(room) + " bytes holds");
    }
    left -= info.bytes;
  }
}

void fill_outline(const Database& database, const VersionRow& row, CatalogEntry& entry) {
  const Manifest manifest = read_manifest(database, row.segment_id, row.what());
  require_room(database, manifest, row.what());
  entry.record = std::make_shared<const SceneRecord>(outline_of(manifest, row.scene, row.what()));
  entry.points = rows_of(manifest, "points");
  entry.keypoints = rows_of(manifest, "keypoints");
  entry.source = make_scene_source(database.path(), row);
}

void fill_whole(const Database& database,
                const VersionRow& row,
                const RunContext& context,
                CatalogEntry& entry) {
  entry.record = load_record(database, row, context);
  entry.points = entry.record->prepared.size();
  entry.keypoints = entry.record->descriptors.size();
}

// The scene as it is now; nothing where it was removed since `scene_id` was listed.
std::optional<CatalogEntry> load_entry(const Database& database,
                                       std::int64_t scene_id,
                                       Loading loading,
                                       const Catalog* previous,
                                       const RunContext& context,
                                       DamagedScene& damage) {
  const Transaction snapshot(database, Transaction::Kind::kRead);
  damage = {scene_id, {}, 0, {}};
  try {
    const std::vector<VersionRow> versions = read_versions(database, scene_id);
    if (versions.empty()) return std::nullopt;
    damage.name = versions.front().scene;
    const auto active = std::find_if(
        versions.begin(), versions.end(), [](const VersionRow& row) { return row.active; });
    if (active == versions.end()) {
      damage.what = "scene '" + damage.name + "' has no active version";
      return std::nullopt;
    }
    damage.version = active->version;
    if (active->damage) {
      damage.what = active->what() + " is marked as damaged: " + *active->damage;
      return std::nullopt;
    }
    CatalogEntry entry;
    entry.scene_id = scene_id;
    entry.version = active->version;
    entry.sha256 = active->sha256;
    entry.tags = read_tags(database, scene_id);
    entry.landmarks = read_landmarks(database, scene_id);
    const CatalogEntry* same = find_entry(previous, *active);
    if (same != nullptr && (same->source != nullptr) == (loading == Loading::kOutlines)) {
      entry.record = same->record;
      entry.source = same->source;
      entry.points = same->points;
      entry.keypoints = same->keypoints;
    } else if (loading == Loading::kOutlines) {
      fill_outline(database, *active, entry);
    } else {
      fill_whole(database, *active, context, entry);
    }
    return entry;
  } catch (const Error& error) {
    // A segment of a format we do not know harms its own scene only, as damage does.
    if (error.code() != ErrorCode::kDataLoss && error.code() != ErrorCode::kUnimplemented) throw;
    damage.what = error.what();
    return std::nullopt;
  }
}

}  // namespace

Segment load_segment(const Database& database,
                     const VersionRow& row,
                     const RunContext& context,
                     SceneParts parts) {
  try {
    return read_segment(database, row.segment_id, row.what(), context, parts);
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.code() != ErrorCode::kDataLoss || message.starts_with(row.what())) throw;
    throw Error(error.code(), row.what() + ": " + message);
  }
}

std::shared_ptr<const SceneRecord> load_record(const Database& database,
                                               const VersionRow& row,
                                               const RunContext& context,
                                               SceneParts parts) {
  return std::make_shared<const SceneRecord>(
      decode_segment(load_segment(database, row, context, parts), row.scene, row.what(), parts));
}

std::shared_ptr<const Catalog> load_catalog(const Database& database,
                                            Loading loading,
                                            const RunContext& context,
                                            const OnDamaged& on_damaged,
                                            const Catalog* previous) {
  auto catalog = std::make_shared<Catalog>();
  std::vector<std::int64_t> ids;
  {
    const Transaction snapshot(database, Transaction::Kind::kRead);
    catalog->generation = read_generation(database);
    sqlite::Statement rows(database, "SELECT id FROM scene ORDER BY id");
    while (rows.step()) ids.push_back(rows.integer(0));
  }
  for (std::size_t i = 0; i < ids.size(); ++i) {
    context.report("load", i, ids.size());
    DamagedScene damage;
    std::optional<CatalogEntry> entry =
        load_entry(database, ids[i], loading, previous, context, damage);
    if (entry) {
      catalog->entries.push_back(std::move(*entry));
    } else if (!damage.what.empty() && on_damaged) {
      on_damaged(damage);
    }
  }
  context.report("load", ids.size(), ids.size());
  return catalog;
}

}  // namespace landmarkdb
