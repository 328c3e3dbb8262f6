#include "store/repair.hpp"

#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using sqlite::Database;
using sqlite::OpenMode;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_record;
using testing::TempFolder;

class RepairDatabase : public ::testing::Test {
 protected:
  RepairDatabase() {
    Store store = Store::create_or_open(path_);
    store.insert(make_record("attic"), {});
    store.insert(make_record("lobby", 1), {});
    store.insert(make_record("lobby", 3), {});
  }
  void damage(const std::string& sql) const {
    const Database database(path_, OpenMode::kReadWrite, 0ms);
    database.execute("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON");
    database.execute(sql);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("x.db");
};

TEST_F(RepairDatabase, LeavesAWholeOneAlone) {
  Store store = Store::open_read_write(path_);
  const std::uint64_t generation = store.generation();
  const RepairReport report = store.repair({});
  EXPECT_THAT(report.repaired, IsEmpty());
  EXPECT_THAT(report.remaining, IsEmpty());
  EXPECT_EQ(store.generation(), generation);
}

TEST_F(RepairDatabase, RebuildsWhatIsDerived) {
  damage(
      "UPDATE scene_version SET points = 7, kind = 'object', voxel_m = 9 WHERE scene_id = 1; "
      "DROP VIEW scene_list; DROP INDEX scene_version_active; DELETE FROM setting; "
      "INSERT INTO segment_chunk VALUES (999, 0, x'00'); "
      "INSERT INTO tag VALUES (77, 'a', 'b')");
  Store store = Store::open_read_write(path_);
  const RepairReport report = store.repair({});
  EXPECT_THAT(report.remaining, IsEmpty());
  EXPECT_THAT(report.repaired, Contains(HasSubstr("'scene_list' was made anew")));
  EXPECT_THAT(report.repaired, Contains(HasSubstr("1 chunks")));
  EXPECT_THAT(store.check({}).findings, IsEmpty());
  EXPECT_EQ(store.show("attic").points, 200U);
  EXPECT_EQ(store.show("attic").kind, EntryKind::kPlace);
}

TEST_F(RepairDatabase, PromisesNoEarlierVersionWhereThereIsNone) {
  damage(
      "UPDATE segment_chunk SET data = x'00' WHERE array_id IN "
      "(SELECT id FROM segment_array WHERE segment_id = 1 AND name = 'points')");
  const RepairReport report = Store::open_read_write(path_).repair({});
  ASSERT_EQ(report.remaining.size(), 1U);
  EXPECT_THAT(report.remaining[0], HasSubstr("attic' version 1"));
  EXPECT_THAT(report.remaining[0], HasSubstr("; `add` makes a new version"));
}

TEST_F(RepairDatabase, MarksDamageAndSaysWhatCanBeDone) {
  damage(
      "UPDATE segment_chunk SET data = x'00' WHERE array_id IN "
      "(SELECT id FROM segment_array WHERE segment_id = 3 AND name = 'points')");
  Store store = Store::open_read_write(path_);
  const RepairReport report = store.repair({});
  EXPECT_THAT(report.repaired, Contains(HasSubstr("lobby' version 2 is marked as damaged")));
  EXPECT_THAT(report.remaining, Contains(HasSubstr("`rollback lobby`")));
  // Nothing was taken away, the scene is listed as damaged, the rest is served.
  EXPECT_EQ(store.list_scenes().size(), 2U);
  EXPECT_TRUE(store.show("lobby").damage);
  EXPECT_EQ(store.load_catalog({})->entries.size(), 1U);
  EXPECT_EQ(store.rollback("lobby"), 1);
  EXPECT_FALSE(store.show("lobby").damage);
  EXPECT_EQ(store.load_catalog({})->entries.size(), 2U);
  // A rollback never goes to the damaged version.
  store.insert(make_record("lobby"), {});
  EXPECT_EQ(store.rollback("lobby"), 1);
}

TEST_F(RepairDatabase, TakesTheMarkFromWhatIsWholeAgain) {
  damage("UPDATE scene_version SET damage = 'it was said' WHERE scene_id = 1");
  Store store = Store::open_read_write(path_);
  EXPECT_EQ(store.load_catalog({})->entries.size(), 1U);
  EXPECT_FALSE(store.check({}).ok());
  EXPECT_TRUE(store.repair({}).ok());
  EXPECT_EQ(store.load_catalog({})->entries.size(), 2U);
  EXPECT_TRUE(store.check({}).ok());
}

TEST_F(RepairDatabase, KeepsASceneWithoutAnActiveVersion) {
  damage("UPDATE scene_version SET state = 'retired' WHERE scene_id = 2");
  Store store = Store::open_read_write(path_);
  EXPECT_THAT(store.repair({}).remaining, Contains(HasSubstr("'lobby' has no active version")));
  EXPECT_EQ(store.rollback("lobby"), 2);
  EXPECT_TRUE(store.check({}).ok());
}

}  // namespace
}  // namespace landmarkdb
