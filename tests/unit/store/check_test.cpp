#include "store/check.hpp"

#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using sqlite::Database;
using sqlite::OpenMode;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_record;
using testing::read_file;
using ::testing::SizeIs;
using testing::TempFolder;
using testing::write_file;

// Three scenes, then one thing done to the file behind the store's back.
class CheckDatabase : public ::testing::Test {
 protected:
  CheckDatabase() {
    Store store = Store::create_or_open(path_);
    for (const char* name : {"attic", "lobby", "office"}) store.insert(make_record(name), {});
  }

  void damage(const std::string& sql) const {
    const Database database(path_, OpenMode::kReadWrite, 0ms);
    database.execute("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON");
    database.execute(sql);
  }
  std::vector<std::string> findings() const {
    return Store::open_read_only(path_).check({}).findings;
  }

  TempFolder folder_;
  std::string path_ = folder_.file("x.db");
};

// The array of the second scene with this name.
std::string array_of_lobby(const std::string& name) {
  return "(SELECT a.id FROM segment_array a JOIN scene_version v USING (segment_id) "
         "JOIN scene s ON s.id = v.scene_id WHERE s.name = 'lobby' AND a.name = '" +
         name + "')";
}

TEST_F(CheckDatabase, AWholeOneHasNoFindings) {
  const CheckReport report = Store::open_read_only(path_).check({});
  EXPECT_THAT(report.findings, IsEmpty());
  EXPECT_EQ(report.scenes, 3U);
  EXPECT_EQ(report.versions, 3U);
  EXPECT_EQ(report.arrays, 24U);
  EXPECT_GT(report.bytes, 3U * 14'000U);
}

TEST_F(CheckDatabase, AFlippedByteIsNamedAndHarmsNoOtherScene) {
  damage(
      "UPDATE segment_chunk SET data = CAST(substr(data, 1, 99) || x'55' || substr(data, 101) "
      "AS BLOB) WHERE array_id = " +
      array_of_lobby("descriptors"));
  EXPECT_THAT(
      findings(),
      AllOf(SizeIs(1),
            Contains(HasSubstr("scene 'lobby' version 1: array 'descriptors' is damaged"))));
  std::vector<DamagedScene> damaged;
  const auto catalog = Store::open_read_only(path_).load_catalog(
      {}, [&](const DamagedScene& scene) { damaged.push_back(scene); });
  ASSERT_EQ(catalog->entries.size(), 2U);
  EXPECT_EQ(catalog->entries[0].record->name, "attic");
  EXPECT_EQ(catalog->entries[1].record->name, "office");
  ASSERT_THAT(damaged, SizeIs(1));
  EXPECT_EQ(damaged[0].name, "lobby");
  EXPECT_THAT(damaged[0].what, HasSubstr("descriptors"));
}

TEST_F(CheckDatabase, EveryDamagedArrayOfAVersionIsNamed) {
  for (const char* array : {"points", "normals", "descriptors"}) {
    damage(
        "UPDATE segment_chunk SET data = CAST(x'55' || substr(data, 2) AS BLOB) WHERE array_id = " +
        array_of_lobby(array));
  }
  const CheckReport report = Store::open_read_only(path_).check({});
  EXPECT_THAT(report.findings,
              ElementsAre(HasSubstr("lobby' version 1: array 'points' is damaged"),
                          HasSubstr("lobby' version 1: array 'normals' is damaged"),
                          HasSubstr("lobby' version 1: array 'descriptors' is damaged")));
  EXPECT_EQ(report.arrays, 24U) << "damaged ones are looked at too";
}

TEST_F(CheckDatabase, ACutOffArrayIsNamedWithItsLengths) {
  damage("UPDATE segment_chunk SET data = substr(data, 1, 1000) WHERE array_id = " +
         array_of_lobby("descriptors"));
  EXPECT_THAT(findings(),
              Contains("scene 'lobby' version 1: array 'descriptors' has 1000 bytes, want 14080"));
}

TEST_F(CheckDatabase, MissingPartsAreNamed) {
  damage("DELETE FROM segment_chunk WHERE array_id = " + array_of_lobby("points"));
  EXPECT_THAT(findings(), Contains(HasSubstr("array 'points' has 0 bytes, want 2400")));
  damage("DELETE FROM segment_array WHERE id = " + array_of_lobby("points"));
  EXPECT_THAT(findings(), Contains(HasSubstr("array 'points' is missing")));
  damage(
      "DELETE FROM segment WHERE id = (SELECT segment_id FROM scene_version JOIN scene "
      "ON scene.id = scene_id WHERE name = 'lobby')");
  EXPECT_THAT(findings(), Contains(HasSubstr("scene 'lobby' version 1: its segment 2 is missing")));
  EXPECT_THAT(findings(), Contains(HasSubstr("refers to a row of 'segment'")));
}

TEST_F(CheckDatabase, AnAlteredManifestIsSeen) {
  damage("UPDATE segment SET manifest = replace(manifest, '0.05', '0.06') WHERE id = 2");
  EXPECT_THAT(findings(), Contains(HasSubstr("lobby' version 1: its manifest is damaged")));
}

TEST_F(CheckDatabase, AnAlteredArrayRowIsSeen) {
  damage(
      "UPDATE segment_array SET shape = '[1000000000000,3]', bytes = 12000000000000 WHERE id = " +
      array_of_lobby("points"));
  EXPECT_THAT(findings(), Contains(HasSubstr("'points' disagrees with the manifest")));
}

TEST_F(CheckDatabase, AlteredListingsAreSeen) {
  damage("UPDATE scene_version SET points = 7 WHERE scene_id = 2");
  EXPECT_THAT(findings(), Contains(HasSubstr("disagrees with its manifest")));
}

TEST_F(CheckDatabase, OrphansAndMissingObjectsAreSeen) {
  damage(
      "INSERT INTO segment_chunk VALUES (999, 0, x'00'); DROP VIEW scene_list; "
      "DELETE FROM setting; UPDATE scene_version SET state = 'retired' WHERE scene_id = 3");
  const auto found = findings();
  EXPECT_THAT(found, Contains(HasSubstr("1 chunks belong to nothing")));
  EXPECT_THAT(found, Contains(HasSubstr("the view 'scene_list' is missing")));
  EXPECT_THAT(found, Contains(HasSubstr("setting 'generation'")));
  EXPECT_THAT(found, Contains(HasSubstr("scene 'office' has no active version")));
}

// Opens, checks, lists and loads; true when any of it saw that something is wrong.
bool damage_is_seen(const std::string& path) {
  bool seen = false;
  try {
    const Store store = Store::open_read_only(path);
    seen = !store.check({}).ok();
    store.load_catalog({});
    store.list_scenes();
  } catch (const Error&) {
    seen = true;
  }
  std::filesystem::remove(path + "-shm");
  std::filesystem::remove(path + "-wal");
  return seen;
}

TEST_F(CheckDatabase, BytesOverwrittenInTheFileAreSeenAndNeverCrashIt) {
  // Large enough that most of the file is arrays; the rest of it is unused parts of pages.
  Store::open_read_write(path_).insert(make_record("hall", 1, {.points = 40'000}), {});
  const std::string whole = read_file(path_);
  const std::string path = folder_.file("overwritten.db");
  Random random(11);
  int seen = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    std::string bytes = whole;
    const std::size_t at = random.below(bytes.size() - 64);
    for (std::size_t i = 0; i < 64; ++i) bytes[at + i] = static_cast<char>(random.next());
    write_file(path, bytes);
    if (damage_is_seen(path)) ++seen;
  }
  EXPECT_GT(seen, kRounds / 2);
}

TEST_F(CheckDatabase, NoByteOfTheHeaderCrashesIt) {
  const std::string whole = read_file(path_);
  const std::string path = folder_.file("overwritten.db");
  for (std::size_t at = 0; at < 100; ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x5a);
    write_file(path, bytes);
    const bool seen = damage_is_seen(path);
    if (at < 16 || (at >= 60 && at < 64) || (at >= 68 && at < 72)) {
      EXPECT_TRUE(seen) << at;  // the magic, our version and our id
    }
  }
}

TEST_F(CheckDatabase, CanBeStopped) {
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_EQ(testing::error_of([&] { Store::open_read_only(path_).check(context); }).code,
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace landmarkdb
