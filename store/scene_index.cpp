#include "store/scene_index.hpp"

#include <span>

#include "engine/base/error.hpp"
#include "store/catalog.hpp"
#include "store/sha256.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;

// SQLite holds no row past 1e9 bytes; a scene of more than three million keypoints is searched
// without.
constexpr std::size_t kMostBytes = std::size_t{512} << 20U;

// Of a segment's index, one of its two parts.
std::string index_digest(const std::string& segment_sha256,
                         const SceneIndexBlob& index,
                         std::span<const std::byte> part) {
  Sha256 digest;
  const std::string head =
      segment_sha256 + "\n" + std::to_string(index.version) + "\n" + index.params + "\n";
  digest.update(std::as_bytes(std::span(head)));
  digest.update(part);
  return digest.finish();
}

}  // namespace

bool has_scene_index(const Database& database, std::int64_t segment_id) {
  return database.integer("SELECT count(*) FROM scene_index WHERE segment_id = " +
                          std::to_string(segment_id)) > 0;
}

std::optional<SceneIndexBlob> read_scene_index(const Database& database,
                                               const VersionRow& row,
                                               bool with_tails) {
  Statement rows(database,
                 with_tails ? "SELECT version, params, codes, digest, tails, tails_digest "
                              "FROM scene_index WHERE segment_id = ?"
                            : "SELECT version, params, codes, digest "
                              "FROM scene_index WHERE segment_id = ?");
  rows.bind(row.segment_id);
  if (!rows.step()) return std::nullopt;
  SceneIndexBlob index{rows.integer(0), rows.text(1), {}, {}};
  const std::span<const std::byte> codes = rows.blob(2);
  index.codes.assign(codes.begin(), codes.end());
  if (index_digest(row.sha256, index, index.codes) != rows.text(3)) return std::nullopt;
  if (!with_tails) return index;
  const std::span<const std::byte> tails = rows.blob(4);
  index.tails.assign(tails.begin(), tails.end());
  if (index_digest(row.sha256, index, index.tails) != rows.text(5)) return std::nullopt;
  return index;
}

std::optional<SceneIndexBlob> derive_scene_index(const Segment& segment,
                                                 const SceneDeriver& deriver,
                                                 const RunContext& context) {
  if (!deriver.index) return std::nullopt;
  SceneIndexBlob index =
      deriver.index(decode_segment(segment, {}, "the scene to be indexed"), context);
  if (index.codes.size() + index.tails.size() > kMostBytes) return std::nullopt;
  return index;
}

void write_scene_index(const Database& database,
                       std::int64_t segment_id,
                       const std::string& segment_sha256,
                       const SceneIndexBlob& index) {
  const std::string digest = index_digest(segment_sha256, index, index.codes);
  const std::string tails_digest = index_digest(segment_sha256, index, index.tails);
  Statement insert(
      database,
      "INSERT OR REPLACE INTO scene_index (segment_id, version, params, codes, digest, "
      "tails, tails_digest) VALUES (?, ?, ?, ?, ?, ?, ?)");
  insert.bind(segment_id).bind(index.version).bind(index.params);
  insert.bind(std::span<const std::byte>(index.codes)).bind(digest);
  insert.bind(std::span<const std::byte>(index.tails)).bind(tails_digest);
  insert.run();
}

std::optional<std::string> renew_scene_index(const Database& database,
                                             const VersionRow& row,
                                             const SceneDeriver& deriver,
                                             const RunContext& context) {
  const std::optional<SceneIndexBlob> index = read_scene_index(database, row, true);
  if (index && (!deriver.index || index->is_made_like(deriver.index_format))) return std::nullopt;
  if (deriver.index) {
    const auto made = derive_scene_index(load_segment(database, row, context), deriver, context);
    if (made) {
      write_scene_index(database, row.segment_id, row.sha256, *made);
      return row.what() + ": its search index was made anew";
    }
  }
  if (!has_scene_index(database, row.segment_id)) return std::nullopt;
  database.execute("DELETE FROM scene_index WHERE segment_id = " + std::to_string(row.segment_id));
  return row.what() + ": its damaged search index was dropped";
}

std::vector<std::string> renew_scene_indexes(const Database& database,
                                             const RunContext& context,
                                             const SceneDeriver& deriver) {
  std::vector<std::string> renewed;
  const std::vector<VersionRow> rows = read_versions(database);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    context.report("index", i, rows.size());
    if (rows[i].damage) continue;
    sqlite::Transaction transaction(database, sqlite::Transaction::Kind::kWrite);
    try {
      const auto done = renew_scene_index(database, rows[i], deriver, context);
      if (!done) continue;
      renewed.push_back(*done);
      transaction.commit();
    } catch (const Error& error) {  // damage that nobody has marked yet: `check` tells of it
      if (error.code() != ErrorCode::kDataLoss) throw;
    }
  }
  return renewed;
}

}  // namespace landmarkdb
