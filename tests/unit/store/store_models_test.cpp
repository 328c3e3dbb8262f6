#include <chrono>
#include <cmath>

#include "store/model_bytes.hpp"
#include "store/sqlite.hpp"
#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using sqlite::Database;
using sqlite::OpenMode;
using ::testing::Contains;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_record;
using testing::TempFolder;

// A record with something in every table.
MonoModelRecord make_model(const std::string& name, double size_m = 0.1) {
  MonoModelRecord record;
  MonoModel& model = record.model;
  model.name = name;
  model.source = "tile.json";
  model.unit_scale = 0.001;
  model.points = {{FeatureType::kVertex, {0, 0, 0}},
                  {FeatureType::kVertex, {size_m, 0, 0}},
                  {FeatureType::kVertex, {0, size_m, 0}},
                  {FeatureType::kConicCentre, {0.01, 0.01, 0}, Eigen::Vector3d::UnitZ(), 0},
                  {FeatureType::kCentroid, {size_m / 3, size_m / 3, 0}, std::nullopt, 0}};
  model.edges = {{0, 1}, {0, 2}, {1, 2}};
  model.circles = {{{0.01, 0.01, 0}, Eigen::Vector3d::UnitZ(), 0.005}};
  model.faces = {{0, 1, 2}};
  model.symmetries = {Eigen::Matrix4d::Identity()};
  model.diameter_m = size_m * std::sqrt(2.0);
  ModelTriple triple;
  triple.points = {0, 1, 2};
  triple.links = 3;
  triple.face = 0;
  triple.lengths_m = {size_m, size_m, size_m * std::sqrt(2.0)};
  triple.inverse = {1 / size_m, 0.0, 1 / size_m};
  triple.min_sin = std::sqrt(0.5);
  triple.views.set(0).set(9).set(255);
  record.triples = {triple};
  return record;
}

std::vector<ModelTriple> triples_of(const MonoModel& model, const RunContext&) {
  return make_model("any", model.points[1].xyz.x()).triples;
}

void expect_same(const MonoModelRecord& seen, const MonoModelRecord& wanted) {
  EXPECT_EQ(seen.model.name, wanted.model.name);
  EXPECT_EQ(model_digest(seen.model), model_digest(wanted.model));
  EXPECT_EQ(triples_digest(seen.triples), triples_digest(wanted.triples));
}

TEST(StoreModels, GiveBackWhatWasStored) {
  Store store = Store::create_or_open(":memory:");
  const std::uint64_t before = store.generation();
  const InsertModelResult stored = store.insert_model(make_model("tile"), {"a warning"}, {});
  EXPECT_FALSE(stored.replaced);
  EXPECT_GT(stored.generation, before);
  expect_same(*store.load_model("tile"), make_model("tile"));
  const ModelSummary summary = store.show_model("tile");
  EXPECT_EQ(summary.points, 5U);
  EXPECT_THAT(summary.points_of_type, ElementsAre(3, 1, 1, 0));
  EXPECT_EQ(summary.edges, 3U);
  EXPECT_EQ(summary.faces, 1U);
  EXPECT_EQ(summary.circles, 1U);
  EXPECT_EQ(summary.triples, 1U);
  EXPECT_EQ(summary.symmetries, 1U);
  EXPECT_EQ(summary.source, "tile.json");
  EXPECT_THAT(summary.warnings, ElementsAre("a warning"));
  EXPECT_TRUE(store.check({}).ok());
  EXPECT_EQ(store.check({}).models, 1U);
}

TEST(StoreModels, HaveNamesOfTheirOwn) {
  Store store = Store::create_or_open(":memory:");
  store.insert(make_record("tile"), {});
  store.insert_model(make_model("tile"), {}, {});
  store.insert_model(make_model("bolt"), {}, {});
  ASSERT_EQ(store.list_models().size(), 2U);
  EXPECT_EQ(store.list_models()[0].name, "bolt");
  store.remove("tile");
  EXPECT_EQ(store.show_model("tile").name, "tile");
  store.rename_model("tile", "slab");
  EXPECT_EQ(store.load_model("slab")->model.name, "slab");
  EXPECT_EQ(error_of([&] { store.rename_model("slab", "bolt"); }).code, ErrorCode::kAlreadyExists);
  store.remove_model("slab");
  EXPECT_EQ(error_of([&] { store.remove_model("slab"); }).code, ErrorCode::kNotFound);
  EXPECT_TRUE(store.check({}).ok());
}

TEST(StoreModels, AreReplacedUnderTheirName) {
  Store store = Store::create_or_open(":memory:");
  const auto first = store.insert_model(make_model("tile", 0.1), {}, {});
  const auto catalog = store.load_models({});
  const auto second = store.insert_model(make_model("tile", 0.2), {}, {});
  EXPECT_TRUE(second.replaced);
  EXPECT_NE(first.model_id, second.model_id);
  expect_same(*store.load_model("tile"), make_model("tile", 0.2));
  EXPECT_TRUE(store.check({}).ok());
}

TEST(StoreModels, AreSharedBetweenCataloguesWhereTheyDidNotChange) {
  Store store = Store::create_or_open(":memory:");
  store.insert_model(make_model("a"), {}, {});
  const auto before = store.load_models({});
  store.insert_model(make_model("b"), {}, {});
  const auto after = store.load_models({}, {}, before.get());
  ASSERT_EQ(after->entries.size(), 2U);
  EXPECT_EQ(after->entries[0].record, before->entries[0].record);
  EXPECT_GT(after->generation, before->generation);
}

TEST(StoreModels, ThatDoNotFitTogetherAreRefusedWhole) {
  Store store = Store::create_or_open(":memory:");
  const auto refused = [&](const auto& spoil) {
    MonoModelRecord record = make_model("tile");
    spoil(record);
    EXPECT_EQ(error_of([&] { store.insert_model(record, {}, {}); }).code,
              ErrorCode::kInvalidArgument);
  };
  refused([](auto& r) { r.model.name = "a/b"; });
  refused([](auto& r) { r.model.points.clear(); });
  refused([](auto& r) { r.model.points[1].xyz.x() = NAN; });
  refused([](auto& r) { r.model.points[3].normal = Eigen::Vector3d(0, 0, 2); });
  refused([](auto& r) { r.model.points[3].part = 1; });
  refused([](auto& r) { r.model.edges[0] = {0, 5}; });
  refused([](auto& r) { r.model.faces[0] = {0, 1, 9}; });
  refused([](auto& r) { r.model.circles[0].radius_m = 0; });
  refused([](auto& r) { r.model.symmetries.clear(); });
  refused([](auto& r) { r.triples[0].points[2] = 77; });
  EXPECT_THAT(store.list_models(), IsEmpty());
}

// What a deriver makes: the model's number of points, and nothing else.
ModelIndexBlob index_of(const MonoModel& model, const RunContext&) {
  return {3, "a maker", {std::byte{static_cast<unsigned char>(model.points.size())}}};
}
const ModelDeriver kDeriver{triples_of, index_of, {3, "a maker", {}}};

MonoModelRecord indexed_model(const std::string& name) {
  MonoModelRecord record = make_model(name);
  record.index = index_of(record.model, {});
  return record;
}

TEST(StoreModels, KeepTheirIndexUnderAnyName) {
  Store store = Store::create_or_open(":memory:");
  store.insert_model(indexed_model("tile"), {}, {});
  store.insert_model(make_model("bolt"), {}, {});
  store.rename_model("tile", "slab");
  const auto record = store.load_model("slab");
  ASSERT_TRUE(record->index);
  EXPECT_TRUE(record->index->is_made_like(kDeriver.index_format));
  EXPECT_EQ(record->index->quads, std::vector{std::byte{5}});
  EXPECT_FALSE(store.load_model("bolt")->index);
  ASSERT_EQ(store.load_models({})->entries.size(), 2U);
  EXPECT_TRUE(store.load_models({})->entries[0].record->index);
  EXPECT_TRUE(store.check({}).ok());
  store.insert_model(make_model("slab"), {}, {});
  EXPECT_FALSE(store.load_model("slab")->index);
}

// Damaged, of another model, another layout's under this one's number: never handed out.
TEST(StoreModels, WithADamagedIndexAreServedWithoutIt) {
  for (const char* sql : {"UPDATE mono_index SET quads = x'01'",
                          "UPDATE mono_index SET quads = x'0502'",
                          "UPDATE mono_index SET quads = x''",
                          "UPDATE mono_index SET version = 4",
                          "UPDATE mono_index SET params = 'another maker'",
                          "UPDATE mono_index SET model_id = 1"}) {
    const TempFolder folder;
    const std::string path = folder.file("x.db");
    Store store = Store::create_or_open(path);
    store.insert_model(make_model("bolt", 0.2), {}, {});
    store.insert_model(indexed_model("tile"), {}, {});
    Database(path, OpenMode::kReadWrite, 0ms).execute(sql);
    const auto catalog = store.load_models({});
    ASSERT_EQ(catalog->entries.size(), 2U) << sql;
    for (const MonoCatalogEntry& entry : catalog->entries) EXPECT_FALSE(entry.record->index) << sql;
    EXPECT_THAT(store.check({}).findings, ElementsAre(HasSubstr("search index is damaged"))) << sql;
    const std::uint64_t generation = store.generation();
    EXPECT_THAT(store.optimize({}, kDeriver).renewed,
                Contains(HasSubstr("search index was made anew")))
        << sql;
    EXPECT_EQ(store.generation(), generation) << sql;
    EXPECT_EQ(store.load_model("tile")->index->quads, std::vector{std::byte{5}}) << sql;
    EXPECT_TRUE(store.load_model("bolt")->index) << sql;
    EXPECT_TRUE(store.check({}).ok()) << sql;
  }
}

TEST(StoreModels, HaveAMissingOrOutdatedIndexMadeByRepair) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store store = Store::create_or_open(path);
  store.insert_model(make_model("bolt"), {}, {});
  MonoModelRecord old = indexed_model("tile");
  old.index->version = 2;
  store.insert_model(old, {}, {});
  EXPECT_TRUE(store.check({}).ok());
  EXPECT_THAT(store.repair({}, kDeriver).repaired,
              ElementsAre(HasSubstr("'bolt': its search index was made"),
                          HasSubstr("'tile': its search index was made")));
  EXPECT_EQ(store.load_model("tile")->index->version, 3);
  EXPECT_THAT(store.repair({}, kDeriver).repaired, IsEmpty());
  Database(path, OpenMode::kReadWrite, 0ms)
      .execute("UPDATE mono_index SET quads = x'0103' WHERE model_id = 2");
  EXPECT_THAT(store.repair({}).repaired, ElementsAre(HasSubstr("search index was dropped")));
  EXPECT_TRUE(store.check({}).ok());
}

class DamagedModels : public ::testing::Test {
 protected:
  DamagedModels() {
    Store store = Store::create_or_open(path_);
    store.insert_model(make_model("bolt"), {}, {});
    store.insert_model(make_model("tile"), {}, {});
  }
  void damage(const std::string& sql) const {
    const Database database(path_, OpenMode::kReadWrite, 0ms);
    database.execute("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON");
    database.execute(sql);
  }
  TempFolder folder_;
  std::string path_ = folder_.file("x.db");
};

TEST_F(DamagedModels, AreFoundMarkedAndNotServed) {
  for (const char* sql :
       {"UPDATE mono_feature SET x = 9 WHERE model_id = 2 AND idx = 1",
        "UPDATE mono_feature SET type = 7 WHERE model_id = 2 AND idx = 1",
        "DELETE FROM mono_feature WHERE model_id = 2 AND idx = 0",
        "DELETE FROM mono_edge WHERE model_id = 2 AND b = 2",
        "UPDATE mono_face SET vertex_list = x'00' WHERE model_id = 2",
        "UPDATE mono_face SET vertex_list = x'ffffffffffffffffffffffff' WHERE model_id = 2",
        "UPDATE mono_circle SET radius = -1 WHERE model_id = 2",
        "UPDATE mono_model SET symmetries = x'01' WHERE id = 2",
        "UPDATE mono_model SET symmetry = 'c9' WHERE id = 2",
        "UPDATE mono_feature SET part = -5 WHERE model_id = 2 AND idx = 3"}) {
    const std::string whole = testing::read_file(path_);
    damage(sql);
    Store store = Store::open_read_write(path_);
    EXPECT_THAT(store.check({}).findings, Contains(HasSubstr("model 'tile'"))) << sql;
    std::vector<std::string> told;
    EXPECT_EQ(store.load_models({}, [&](const DamagedModel& m) { told.push_back(m.name); })
                  ->entries.size(),
              1U)
        << sql;
    EXPECT_THAT(told, ElementsAre("tile")) << sql;
    EXPECT_EQ(error_of([&] { store.load_model("tile"); }).code, ErrorCode::kDataLoss) << sql;
    const RepairReport repair = store.repair({}, {triples_of});
    EXPECT_THAT(repair.remaining, Contains(HasSubstr("model 'tile'"))) << sql;
    EXPECT_THAT(repair.repaired, Contains(HasSubstr("marked as damaged"))) << sql;
    EXPECT_TRUE(store.show_model("tile").damage) << sql;
    // Storing it again heals it.
    store.insert_model(make_model("tile"), {}, {});
    EXPECT_EQ(store.load_models({})->entries.size(), 2U) << sql;
    EXPECT_TRUE(store.check({}).ok()) << sql;
    damage(
        "DELETE FROM mono_model; DELETE FROM mono_feature; DELETE FROM mono_edge; DELETE FROM "
        "mono_face; DELETE FROM mono_circle; DELETE FROM mono_triple; DELETE FROM "
        "sqlite_sequence WHERE name = 'mono_model'");
    store.insert_model(make_model("bolt"), {}, {});
    store.insert_model(make_model("tile"), {}, {});
  }
}

TEST_F(DamagedModels, DerivedPartsAreMadeAnew) {
  damage(
      "UPDATE mono_triple SET basis = zeroblob(120) WHERE model_id = 2; "
      "UPDATE mono_feature SET edge_mask = x'00' WHERE model_id = 1; DROP VIEW mono_list; "
      "DROP INDEX mono_triple_signature; "
      "INSERT INTO mono_face VALUES (99, 0, zeroblob(12))");
  Store store = Store::open_read_write(path_);
  EXPECT_FALSE(store.check({}).ok());
  EXPECT_EQ(error_of([&] { store.load_model("tile"); }).code, ErrorCode::kDataLoss);
  const RepairReport report = store.repair({}, {triples_of});
  EXPECT_THAT(report.remaining, IsEmpty());
  EXPECT_THAT(report.repaired, Contains(HasSubstr("'tile': its triples were made anew")));
  EXPECT_THAT(report.repaired, Contains(HasSubstr("'bolt': its edge masks")));
  EXPECT_THAT(store.check({}).findings, IsEmpty());
  expect_same(*store.load_model("tile"), make_model("tile"));
}

TEST_F(DamagedModels, WithoutAMakerOfTriplesTheyStayAndAreTold) {
  damage("DELETE FROM mono_triple WHERE model_id = 2");
  Store store = Store::open_read_write(path_);
  EXPECT_THAT(store.repair({}).remaining, ElementsAre(HasSubstr("triples are damaged")));
}

TEST_F(DamagedModels, TheMarkGoesWhenTheModelIsWhole) {
  damage("UPDATE mono_model SET damage = 'it was said' WHERE id = 1");
  Store store = Store::open_read_write(path_);
  EXPECT_EQ(store.load_models({})->entries.size(), 1U);
  EXPECT_TRUE(store.repair({}).ok());
  EXPECT_EQ(store.load_models({})->entries.size(), 2U);
}

TEST(StoreModels, AreListedForTheShell) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert_model(make_model("tile"), {}, {});
  const Database database(path, OpenMode::kReadOnly, 0ms);
  EXPECT_EQ(database.integer("SELECT points FROM mono_list WHERE name = 'tile'"), 5);
}

}  // namespace
}  // namespace landmarkdb
