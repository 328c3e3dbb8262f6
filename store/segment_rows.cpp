#include "store/segment_rows.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "store/sha256.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  std::string text = "[";
  for (const std::uint64_t dimension : shape) {
    if (text.size() > 1) text += ',';
    text += std::to_string(dimension);
  }
  return text + "]";
}

std::int64_t write_array_row(const Database& database,
                             std::int64_t segment_id,
                             std::size_t position,
                             const ArrayInfo& info) {
  const std::string shape = shape_text(info.shape);
  Statement insert(database,
                   "INSERT INTO segment_array (segment_id, position, name, dtype, shape, bytes, "
                   "sha256) VALUES (?, ?, ?, ?, ?, ?, ?)");
  insert.bind(segment_id)
      .bind(static_cast<std::int64_t>(position))
      .bind(info.name)
      .bind(dtype_name(info.dtype))
      .bind(shape)
      .bind(static_cast<std::int64_t>(info.bytes))
      .bind(info.sha256);
  insert.run();
  return database.last_insert_id();
}

[[noreturn]] void damaged(const std::string& what, const std::string& why) {
  throw Error(ErrorCode::kDataLoss, what + ": " + why);
}

struct SegmentRow {
  std::string manifest_json;
  std::string sha256;
  std::uint64_t bytes = 0;
};

SegmentRow read_segment_row(const Database& database,
                            std::int64_t segment_id,
                            const std::string& what) {
  Statement size(database, "SELECT length(CAST(manifest AS BLOB)) FROM segment WHERE id = ?");
  size.bind(segment_id);
  if (!size.step()) damaged(what, "its segment " + std::to_string(segment_id) + " is missing");
  if (size.integer(0) > static_cast<std::int64_t>(kMaxManifestBytes)) {
    damaged(what, "its manifest has " + std::to_string(size.integer(0)) + " bytes");
  }
  Statement row(database, "SELECT manifest, sha256, bytes FROM segment WHERE id = ?");
  row.bind(segment_id);
  if (!row.step()) damaged(what, "its segment " + std::to_string(segment_id) + " is missing");
  SegmentRow result{row.text(0), row.text(1), static_cast<std::uint64_t>(row.integer(2))};
  if (sha256_of(result.manifest_json) != result.sha256) {
    damaged(what, "its manifest is damaged: the digest does not fit");
  }
  return result;
}

// The id of the array's row; what the row says must be what the manifest says.
std::int64_t find_array(const Database& database,
                        std::int64_t segment_id,
                        std::size_t position,
                        const ArrayInfo& info,
                        const std::string& what) {
  Statement row(database,
                "SELECT id, name, dtype, shape, bytes, sha256 FROM segment_array "
                "WHERE segment_id = ? AND position = ?");
  row.bind(segment_id).bind(static_cast<std::int64_t>(position));
  if (!row.step()) damaged(what, "array '" + info.name + "' is missing");
  if (row.text(1) != info.name || row.text(2) != dtype_name(info.dtype) ||
      row.text(3) != shape_text(info.shape) ||
      row.integer(4) != static_cast<std::int64_t>(info.bytes) || row.text(5) != info.sha256) {
    damaged(what, "the row of array '" + info.name + "' disagrees with the manifest");
  }
  return row.integer(0);
}

std::vector<std::byte> read_array(const Database& database,
                                  std::int64_t array_id,
                                  const ArrayInfo& info,
                                  const std::string& what,
                                  const RunContext& context) {
  Statement size(database, "SELECT sum(length(data)) FROM segment_chunk WHERE array_id = ?");
  size.bind(array_id);
  size.step();
  const auto stored = static_cast<std::uint64_t>(std::max<std::int64_t>(size.integer(0), 0));
  if (stored != info.bytes) {
    damaged(what,
            "array '" + info.name + "' has " + std::to_string(stored) + " bytes, want " +
                std::to_string(info.bytes));
  }
  std::vector<std::byte> bytes(stored);
  std::size_t filled = 0;
  Statement chunks(database, "SELECT data FROM segment_chunk WHERE array_id = ? ORDER BY n");
  chunks.bind(array_id);
  while (chunks.step()) {
    context.check("load");
    const std::span<const std::byte> chunk = chunks.blob(0);
    if (chunk.size() > bytes.size() - filled) damaged(what, "array '" + info.name + "' changed");
    if (!chunk.empty()) std::memcpy(bytes.data() + filled, chunk.data(), chunk.size());
    filled += chunk.size();
  }
  if (filled != bytes.size()) damaged(what, "array '" + info.name + "' is cut off");
  verify_array(info, bytes, what);
  return bytes;
}

}  // namespace

std::int64_t write_segment(const Database& database,
                           const Segment& segment,
                           const RunContext& context) {
  const std::uint64_t total = segment.bytes();
  {
    Statement insert(database,
                     "INSERT INTO segment (format, bytes, manifest, sha256) VALUES (?, ?, ?, ?)");
    insert.bind(kSegmentFormat)
        .bind(static_cast<std::int64_t>(total))
        .bind(segment.manifest_json)
        .bind(segment.sha256);
    insert.run();
  }
  const std::int64_t segment_id = database.last_insert_id();
  Statement insert(database, "INSERT INTO segment_chunk (array_id, n, data) VALUES (?, ?, ?)");
  std::uint64_t done = 0;
  for (std::size_t i = 0; i < segment.arrays.size(); ++i) {
    const std::int64_t array_id =
        write_array_row(database, segment_id, i, segment.manifest.arrays[i]);
    const std::span<const std::byte> bytes(segment.arrays[i]);
    for (std::size_t begin = 0, n = 0; begin < bytes.size(); begin += kChunkBytes, ++n) {
      context.report("store", done, total);
      const auto chunk = bytes.subspan(begin, std::min(kChunkBytes, bytes.size() - begin));
      insert.bind(array_id).bind(static_cast<std::int64_t>(n)).bind(chunk);
      insert.run();
      done += chunk.size();
    }
  }
  context.report("store", total, total);
  return segment_id;
}

Segment read_segment(const Database& database,
                     std::int64_t segment_id,
                     const std::string& what,
                     const RunContext& context,
                     SceneParts parts) {
  SegmentRow row = read_segment_row(database, segment_id, what);
  Segment segment;
  segment.manifest = manifest_from_json(row.manifest_json, what);
  segment.manifest_json = std::move(row.manifest_json);
  segment.sha256 = std::move(row.sha256);
  for (std::size_t i = 0; i < segment.manifest.arrays.size(); ++i) {
    const ArrayInfo& info = segment.manifest.arrays[i];
    if (!is_part(info.name, parts)) {
      segment.arrays.emplace_back();
      continue;
    }
    const std::int64_t array_id = find_array(database, segment_id, i, info, what);
    segment.arrays.push_back(read_array(database, array_id, info, what, context));
  }
  if (parts == SceneParts::kWhole && segment.bytes() != row.bytes) {
    damaged(what,
            "its segment says " + std::to_string(row.bytes) + " bytes, its arrays have " +
                std::to_string(segment.bytes()));
  }
  return segment;
}

std::vector<std::string> array_faults(const Database& database,
                                      std::int64_t segment_id,
                                      const Manifest& manifest,
                                      const std::string& what,
                                      const RunContext& context,
                                      std::uint64_t& bytes) {
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < manifest.arrays.size(); ++i) {
    const ArrayInfo& info = manifest.arrays[i];
    try {
      const std::int64_t array_id = find_array(database, segment_id, i, info, what);
      bytes += read_array(database, array_id, info, what, context).size();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kDataLoss) throw;
      faults.emplace_back(error.what());
    }
  }
  return faults;
}

Manifest read_manifest(const Database& database, std::int64_t segment_id, const std::string& what) {
  return manifest_from_json(read_segment_row(database, segment_id, what).manifest_json, what);
}

void delete_segment(const Database& database, std::int64_t segment_id) {
  Statement remove(database, "DELETE FROM segment WHERE id = ?");
  remove.bind(segment_id);
  remove.run();
}

}  // namespace landmarkdb
