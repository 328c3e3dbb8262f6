#include "engine/retrieval/entries.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "engine/retrieval/narrow_places.hpp"
#include "engine/retrieval/scene_index.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"
#include "tests/unit/engine/retrieval/scene_shelf.hpp"

namespace landmarkdb {
namespace {

// The same catalogue, each scene read from a shelf.
std::shared_ptr<const Catalog> shelved(const Catalog& catalog,
                                       std::vector<std::shared_ptr<testing::SceneShelf>>& shelves) {
  auto copy = std::make_shared<Catalog>(catalog);
  for (CatalogEntry& entry : copy->entries) shelves.push_back(testing::put_on_shelf(entry));
  return copy;
}

class OnDemand : public ::testing::Test {
 protected:
  OnDemand() {
    auto catalog = std::make_shared<Catalog>();
    for (const std::uint64_t seed : {2U, 3U}) {
      CatalogEntry entry;
      entry.scene_id = static_cast<std::int64_t>(seed);
      entry.record = std::make_shared<const SceneRecord>(
          testing::describe_room("room " + std::to_string(seed), testing::small_room(seed)));
      catalog->entries.push_back(std::move(entry));
    }
    in_memory = catalog;
    on_shelves = shelved(*catalog, shelves);
  }
  QueryResult ask(const Localizer& localizer) const {
    return localizer.query(testing::frame_in(testing::small_room(2), 1).cloud, {}, {});
  }

  std::vector<std::shared_ptr<testing::SceneShelf>> shelves;
  std::shared_ptr<const Catalog> in_memory, on_shelves;
};

TEST_F(OnDemand, AnswersAsIfAllWereInMemoryWhateverIsKept) {
  const QueryResult want = ask(Localizer(in_memory, {}, {.most_scanned_rows = 1}));
  ASSERT_FALSE(want.hypotheses.empty());
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1} << 30U}) {
    const Localizer localizer(
        on_shelves, {}, {.scene_memory_bytes = bytes, .most_scanned_rows = 1});
    EXPECT_EQ(localizer.loaded().scenes, 2U);
    for (int turn = 0; turn < 2; ++turn) {
      const QueryResult got = ask(localizer);
      ASSERT_EQ(got.hypotheses.size(), want.hypotheses.size());
      EXPECT_EQ(got.status, want.status);
      EXPECT_EQ(got.hypotheses[0].T_scene_sensor, want.hypotheses[0].T_scene_sensor);
      EXPECT_EQ(got.hypotheses[0].confidence, want.hypotheses[0].confidence);
    }
    EXPECT_EQ(localizer.loaded().bytes > 0, bytes > 0);
  }
}

// Of more places than are looked at closely, most are alike.
TEST_F(OnDemand, ReadsAFewOfManyPlacesAndFindsTheRightOne) {
  constexpr std::size_t kPlaces = kAllPlaces + 6;
  auto many = std::make_shared<Catalog>(*in_memory);
  for (std::size_t i = 2; i < kPlaces; ++i) {
    auto copy = std::make_shared<SceneRecord>(*in_memory->entries[1].record);
    copy->name = "copy " + std::to_string(i);
    many->entries.push_back(in_memory->entries[1]);
    many->entries.back().scene_id = static_cast<std::int64_t>(i) + 2;
    many->entries.back().record = std::move(copy);
  }
  const QueryResult in_full = ask(Localizer(many, {}));
  EXPECT_EQ(in_full.status, QueryStatus::kLocalized) << in_full.reason;
  ASSERT_FALSE(in_full.hypotheses.empty());
  EXPECT_EQ(in_full.hypotheses[0].scene, "room 2");

  std::vector<QueryResult> answers;
  for (const bool indexed : {false, true}) {
    std::vector<std::shared_ptr<testing::SceneShelf>> many_shelves;
    const std::shared_ptr<const Catalog> stored = shelved(*many, many_shelves);
    for (std::size_t i = 0; i < kPlaces; ++i) {
      if (indexed) many_shelves[i]->stored_index = make_scene_index(*many->entries[i].record, {});
    }
    const Localizer localizer(stored, {}, {.most_scanned_rows = 1});
    for (const auto& shelf : many_shelves) shelf->loads = 0;
    answers.push_back(ask(localizer));
    const auto read = std::count_if(many_shelves.begin(),
                                    many_shelves.end(),
                                    [](const auto& shelf) { return shelf->loads > 0; });
    EXPECT_GE(read, 1);
    EXPECT_LE(read, static_cast<std::ptrdiff_t>(kMostPlaces + 1));  // room 1 is a level alone
  }
  for (const QueryResult& answer : answers) {
    EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
    ASSERT_FALSE(answer.hypotheses.empty());
    EXPECT_EQ(answer.hypotheses[0].scene, "room 2");
    EXPECT_EQ(answer.hypotheses[0].T_scene_sensor, answers[0].hypotheses[0].T_scene_sensor);
    EXPECT_EQ(answer.hypotheses[0].confidence, answers[0].hypotheses[0].confidence);
  }
}

TEST_F(OnDemand, ASceneThatTurnsOutDamagedHarmsNoOther) {
  const Localizer localizer(on_shelves, {}, {.most_scanned_rows = 1});
  shelves[1]->damaged = true;
  const QueryResult got = ask(localizer);
  ASSERT_FALSE(got.hypotheses.empty());
  EXPECT_EQ(got.hypotheses[0].scene, "room 2");
  ASSERT_EQ(localizer.damaged().size(), 1U);
  EXPECT_EQ(localizer.damaged()[0].first, 1U);
  QueryOptions options;
  options.scenes = {"room 3"};
  try {
    localizer.query(testing::frame_in(testing::small_room(2), 1).cloud, options, {});
    ADD_FAILURE() << "no Error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kDataLoss);
  }
}

TEST_F(OnDemand, SaysSoWhereEverySceneIsDamaged) {
  const Localizer localizer(on_shelves, {}, {.most_scanned_rows = 1});
  for (const auto& shelf : shelves) shelf->damaged = true;
  for (int time = 0; time < 2; ++time) {  // as it is found, and when it is known
    const QueryResult got = ask(localizer);
    EXPECT_EQ(got.status, QueryStatus::kNotFound);
    EXPECT_THAT(got.reason, ::testing::HasSubstr("every scene asked is damaged"));
  }
}

TEST_F(OnDemand, ASceneTooLargeToBeServedHarmsNoOther) {
  auto vast = std::make_shared<SceneRecord>(*in_memory->entries[1].record);
  vast->prepared.points[0].x() = 1e9F;
  auto catalog = std::make_shared<Catalog>(*in_memory);
  catalog->entries[1].record = vast;
  const Localizer localizer(shelved(*catalog, shelves), {});
  ASSERT_EQ(localizer.damaged().size(), 1U);
  EXPECT_EQ(localizer.damaged()[0].first, 1U);
  EXPECT_NE(localizer.damaged()[0].second.find("too small for points"), std::string::npos);
  const QueryResult got = ask(localizer);
  ASSERT_FALSE(got.hypotheses.empty());
  EXPECT_EQ(got.hypotheses[0].scene, "room 2");
}

TEST_F(OnDemand, ThePaperSearchesWhatIsNotInMemory) {
  QueryOptions options;
  options.profile = Profile::kPaper;
  const PointCloud cloud = testing::frame_in(testing::small_room(2), 1).cloud;
  const QueryResult want = Localizer(in_memory, {}).query(cloud, options, {});
  const QueryResult got =
      Localizer(on_shelves, {}, {.most_scanned_rows = 1}).query(cloud, options, {});
  EXPECT_EQ(got.status, want.status);
  ASSERT_EQ(got.hypotheses.size(), want.hypotheses.size());
  for (std::size_t i = 0; i < got.hypotheses.size(); ++i) {
    EXPECT_EQ(got.hypotheses[i].T_scene_sensor, want.hypotheses[i].T_scene_sensor);
  }
}

}  // namespace
}  // namespace landmarkdb
