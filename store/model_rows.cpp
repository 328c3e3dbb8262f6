#include "store/model_rows.hpp"

#include <utility>

#include "engine/base/error.hpp"
#include "store/manifest.hpp"
#include "store/model_bytes.hpp"
#include "store/scene_changes.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;

constexpr const char* kRowColumns =
    "SELECT id, name, digest, triples_digest, damage FROM mono_model ";

ModelRow row_from(const Statement& row) {
  ModelRow model{row.integer(0), row.text(1), row.text(2), row.text(3)};
  if (!row.is_null(4)) model.damage = row.text(4);
  return model;
}

[[noreturn]] void lost(const ModelRow& row, const std::string& why) {
  throw Error(ErrorCode::kDataLoss, row.what() + ": " + why);
}

// What is stored as `idx` must be 0, 1, 2 ...
void require_next(const ModelRow& row, std::int64_t idx, std::size_t count, const char* what) {
  if (idx != static_cast<std::int64_t>(count)) {
    lost(row, std::string(what) + " " + std::to_string(count) + " is missing");
  }
}

std::uint32_t index_from(const ModelRow& row, std::int64_t value, const char* what) {
  if (value < 0 || value > 0xffffffffLL) {
    lost(row, std::string(what) + " has the index " + std::to_string(value));
  }
  return static_cast<std::uint32_t>(value);
}

Eigen::Vector3d vector_from(const Statement& row, int column) {
  return {row.real(column), row.real(column + 1), row.real(column + 2)};
}

void read_points(const Database& database, const ModelRow& row, MonoModel& model) {
  Statement rows(database,
                 "SELECT idx, type, x, y, z, nx, ny, nz, part FROM mono_feature "
                 "WHERE model_id = ? ORDER BY idx");
  rows.bind(row.id);
  while (rows.step()) {
    require_next(row, rows.integer(0), model.points.size(), "point");
    const std::int64_t type = rows.integer(1);
    if (type < 0 || type >= static_cast<std::int64_t>(kFeatureTypes)) {
      lost(row, "a point has the type " + std::to_string(type));
    }
    ModelFeature point{static_cast<FeatureType>(type), vector_from(rows, 2)};
    if (!rows.is_null(5)) point.normal = vector_from(rows, 5);
    if (!rows.is_null(8)) {
      point.part = static_cast<std::int32_t>(index_from(row, rows.integer(8), "a point's part"));
    }
    model.points.push_back(point);
  }
}

void read_shapes(const Database& database, const ModelRow& row, MonoModel& model) {
  Statement edges(database, "SELECT a, b FROM mono_edge WHERE model_id = ? ORDER BY a, b");
  edges.bind(row.id);
  while (edges.step()) {
    model.edges.push_back({index_from(row, edges.integer(0), "an edge"),
                           index_from(row, edges.integer(1), "an edge")});
  }
  Statement faces(database,
                  "SELECT idx, vertex_list FROM mono_face WHERE model_id = ? ORDER BY idx");
  faces.bind(row.id);
  while (faces.step()) {
    require_next(row, faces.integer(0), model.faces.size(), "face");
    model.faces.push_back(point_list_from(
        faces.blob(1), row.what() + ": face " + std::to_string(model.faces.size())));
  }
  Statement circles(database,
                    "SELECT idx, cx, cy, cz, nx, ny, nz, radius FROM mono_circle "
                    "WHERE model_id = ? ORDER BY idx");
  circles.bind(row.id);
  while (circles.step()) {
    require_next(row, circles.integer(0), model.circles.size(), "circle");
    model.circles.push_back({vector_from(circles, 1), vector_from(circles, 4), circles.real(7)});
  }
}

void write_points(const Database& database, std::int64_t id, const MonoModel& model) {
  Statement insert(database,
                   "INSERT INTO mono_feature (model_id, idx, type, x, y, z, nx, ny, nz, part, "
                   "edge_mask) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::uint32_t i = 0; i < model.points.size(); ++i) {
    const ModelFeature& p = model.points[i];
    const std::vector<std::byte> mask = edge_mask_of(model, i);
    insert.bind(id).bind(std::int64_t{i}).bind(static_cast<std::int64_t>(p.type));
    for (Eigen::Index axis = 0; axis < 3; ++axis) insert.bind(p.xyz[axis]);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      p.normal ? insert.bind((*p.normal)[axis]) : insert.bind_null();
    }
    p.part >= 0 ? insert.bind(std::int64_t{p.part}) : insert.bind_null();
    insert.bind(std::span<const std::byte>(mask));
    insert.run();
  }
}

void write_shapes(const Database& database, std::int64_t id, const MonoModel& model) {
  Statement edge(database, "INSERT INTO mono_edge (model_id, a, b) VALUES (?, ?, ?)");
  for (const auto& [a, b] : model.edges) {
    edge.bind(id).bind(std::int64_t{a}).bind(std::int64_t{b});
    edge.run();
  }
  Statement face(database, "INSERT INTO mono_face (model_id, idx, vertex_list) VALUES (?, ?, ?)");
  for (std::size_t i = 0; i < model.faces.size(); ++i) {
    const std::vector<std::byte> list = bytes_of_indices(model.faces[i]);
    face.bind(id).bind(static_cast<std::int64_t>(i)).bind(std::span<const std::byte>(list));
    face.run();
  }
  Statement circle(database,
                   "INSERT INTO mono_circle (model_id, idx, cx, cy, cz, nx, ny, nz, radius) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < model.circles.size(); ++i) {
    const ModelCircle& c = model.circles[i];
    circle.bind(id).bind(static_cast<std::int64_t>(i));
    for (Eigen::Index axis = 0; axis < 3; ++axis) circle.bind(c.center[axis]);
    for (Eigen::Index axis = 0; axis < 3; ++axis) circle.bind(c.normal[axis]);
    circle.bind(c.radius_m);
    circle.run();
  }
}

std::size_t count_of(const Database& database, const std::string& table, std::int64_t id) {
  return static_cast<std::size_t>(database.integer("SELECT count(*) FROM " + table +
                                                   " WHERE model_id = " + std::to_string(id)));
}

}  // namespace

std::vector<ModelRow> read_model_rows(const Database& database) {
  std::vector<ModelRow> models;
  Statement rows(database, std::string(kRowColumns) + "ORDER BY id");
  while (rows.step()) models.push_back(row_from(rows));
  return models;
}

std::optional<std::int64_t> find_model_id(const Database& database, std::string_view name) {
  Statement row(database, "SELECT id FROM mono_model WHERE name = ?");
  row.bind(name);
  if (!row.step()) return std::nullopt;
  return row.integer(0);
}

ModelRow require_model_row(const Database& database, std::string_view name) {
  Statement row(database, std::string(kRowColumns) + "WHERE name = ?");
  row.bind(name);
  if (row.step()) return row_from(row);
  throw Error(ErrorCode::kNotFound, "there is no model '" + std::string(name) + "'", "model");
}

ModelSummary read_model_summary(const Database& database, std::int64_t model_id) {
  Statement row(database,
                "SELECT name, created, source, unit_scale, diameter, symmetry, "
                "length(symmetries) / 128, warnings, damage, digest FROM mono_model WHERE id = ?");
  row.bind(model_id);
  if (!row.step()) {
    throw Error(ErrorCode::kNotFound, "there is no model of id " + std::to_string(model_id));
  }
  ModelSummary model;
  model.id = model_id;
  model.name = row.text(0);
  model.created = row.text(1);
  model.source = row.text(2);
  model.unit_scale = row.real(3);
  model.diameter_m = row.real(4);
  model.symmetry = row.text(5);
  model.symmetries = static_cast<std::size_t>(row.integer(6));
  model.warnings = texts_from_json(row.text(7));
  if (!row.is_null(8)) model.damage = row.text(8);
  model.sha256 = row.text(9);
  Statement types(database,
                  "SELECT type, count(*) FROM mono_feature WHERE model_id = ? GROUP BY type");
  types.bind(model_id);
  while (types.step()) {
    const auto type = static_cast<std::size_t>(types.integer(0));
    const auto count = static_cast<std::size_t>(types.integer(1));
    model.points += count;
    if (type < kFeatureTypes) model.points_of_type[type] = count;
  }
  model.edges = count_of(database, "mono_edge", model_id);
  model.faces = count_of(database, "mono_face", model_id);
  model.circles = count_of(database, "mono_circle", model_id);
  model.triples = count_of(database, "mono_triple", model_id);
  return model;
}

MonoModel read_model_tables(const Database& database, const ModelRow& row) {
  Statement head(database,
                 "SELECT source, unit_scale, diameter, symmetry, symmetries FROM mono_model "
                 "WHERE id = ?");
  head.bind(row.id);
  if (!head.step()) lost(row, "it is not there");
  MonoModel model;
  model.name = row.name;
  model.source = head.text(0);
  model.unit_scale = head.real(1);
  model.diameter_m = head.real(2);
  model.symmetry_class = head.text(3);
  model.symmetries = symmetries_from(head.blob(4), row.what());
  read_points(database, row, model);
  read_shapes(database, row, model);
  const std::string digest = model_digest(model);
  if (digest != row.sha256) {
    lost(row, "its tables have the digest " + digest + ", want " + row.sha256);
  }
  validate_model({model, {}}, row.what(), ErrorCode::kDataLoss);
  return model;
}

std::vector<ModelTriple> read_triples(const Database& database, const ModelRow& row) {
  Statement rows(database,
                 "SELECT i0, i1, i2, type_sig, links, face, l01, l02, l12, basis, views, min_sin "
                 "FROM mono_triple WHERE model_id = ? ORDER BY i0, i1, i2");
  rows.bind(row.id);
  std::vector<ModelTriple> triples;
  while (rows.step()) {
    ModelTriple triple;
    for (int k = 0; k < 3; ++k) {
      triple.points[static_cast<std::size_t>(k)] = index_from(row, rows.integer(k), "a triple");
      triple.lengths_m[static_cast<std::size_t>(k)] = rows.real(6 + k);
    }
    triple.type_signature = index_from(row, rows.integer(3), "a triple's signature");
    triple.links = static_cast<std::uint8_t>(rows.integer(4));
    triple.face = static_cast<std::int32_t>(rows.integer(5));
    set_basis(triple, rows.blob(9), row.what() + ": a triple");
    triple.views = views_from(rows.blob(10), row.what() + ": a triple");
    triple.min_sin = rows.real(11);
    triples.push_back(triple);
  }
  if (triples_digest(triples) != row.triples_sha256) {
    lost(row, "its triples are damaged; `repair` makes them anew");
  }
  return triples;
}

std::optional<ModelIndexBlob> read_model_index_row(const Database& database, const ModelRow& row) {
  Statement rows(database,
                 "SELECT version, params, quads, digest FROM mono_index WHERE model_id = ?");
  rows.bind(row.id);
  if (!rows.step()) return std::nullopt;
  ModelIndexBlob index;
  index.version = rows.integer(0);
  index.params = rows.text(1);
  const std::span<const std::byte> quads = rows.blob(2);
  index.quads.assign(quads.begin(), quads.end());
  if (index_digest(row.sha256, index) != rows.text(3)) return std::nullopt;
  return index;
}

std::shared_ptr<const MonoModelRecord> read_model_record(const Database& database,
                                                         const ModelRow& row) {
  auto record = std::make_shared<MonoModelRecord>();
  record->model = read_model_tables(database, row);
  record->triples = read_triples(database, row);
  record->index = read_model_index_row(database, row);
  validate_model(*record, row.what(), ErrorCode::kDataLoss);
  return record;
}

std::int64_t write_model(const Database& database,
                         const MonoModelRecord& record,
                         const std::vector<std::string>& warnings,
                         const RunContext& context) {
  const MonoModel& model = record.model;
  const std::string now = utc_now();
  const std::vector<std::byte> symmetries = bytes_of_symmetries(model.symmetries);
  const std::string warning_list = texts_to_json(warnings);
  const std::string digest = model_digest(model);
  const std::string empty_digest = triples_digest({});
  Statement insert(database,
                   "INSERT INTO mono_model (name, created, source, unit_scale, diameter, symmetry, "
                   "symmetries, warnings, digest, triples_digest) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(model.name).bind(now).bind(model.source).bind(model.unit_scale);
  insert.bind(model.diameter_m).bind(model.symmetry_class);
  insert.bind(std::span<const std::byte>(symmetries)).bind(warning_list);
  insert.bind(digest).bind(empty_digest);
  insert.run();
  const std::int64_t id = database.last_insert_id();
  write_points(database, id, model);
  write_shapes(database, id, model);
  write_triples(database, id, record.triples, context);
  if (record.index) write_model_index(database, id, digest, *record.index);
  return id;
}

void write_triples(const Database& database,
                   std::int64_t model_id,
                   const std::vector<ModelTriple>& triples,
                   const RunContext& context) {
  Statement remove(database, "DELETE FROM mono_triple WHERE model_id = ?");
  remove.bind(model_id);
  remove.run();
  Statement insert(
      database,
      "INSERT INTO mono_triple (model_id, i0, i1, i2, type_sig, links, face, l01, "
      "l02, l12, basis, views, min_sin) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < triples.size(); ++i) {
    context.report("store", i, triples.size());
    const ModelTriple& triple = triples[i];
    const std::vector<std::byte> basis = bytes_of_basis(triple);
    const std::vector<std::byte> views = bytes_of_views(triple.views);
    insert.bind(model_id);
    for (const std::uint32_t point : triple.points) insert.bind(std::int64_t{point});
    insert.bind(std::int64_t{triple.type_signature}).bind(std::int64_t{triple.links});
    insert.bind(std::int64_t{triple.face});
    for (const double length : triple.lengths_m) insert.bind(length);
    insert.bind(std::span<const std::byte>(basis)).bind(std::span<const std::byte>(views));
    insert.bind(triple.min_sin);
    insert.run();
  }
  const std::string digest = triples_digest(triples);
  Statement update(database, "UPDATE mono_model SET triples_digest = ? WHERE id = ?");
  update.bind(digest).bind(model_id);
  update.run();
}

void write_model_index(const Database& database,
                       std::int64_t model_id,
                       const std::string& model_sha256,
                       const ModelIndexBlob& index) {
  const std::string digest = index_digest(model_sha256, index);
  Statement insert(database,
                   "INSERT OR REPLACE INTO mono_index (model_id, version, params, quads, digest) "
                   "VALUES (?, ?, ?, ?, ?)");
  insert.bind(model_id).bind(index.version).bind(index.params);
  insert.bind(std::span<const std::byte>(index.quads)).bind(digest);
  insert.run();
}

void delete_model(const Database& database, std::int64_t model_id) {
  for (const char* table :
       {"mono_index", "mono_triple", "mono_circle", "mono_face", "mono_edge", "mono_feature"}) {
    Statement remove(database, "DELETE FROM " + std::string(table) + " WHERE model_id = ?");
    remove.bind(model_id);
    remove.run();
  }
  Statement remove(database, "DELETE FROM mono_model WHERE id = ?");
  remove.bind(model_id);
  remove.run();
}

}  // namespace landmarkdb
