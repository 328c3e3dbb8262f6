#include "server/server_state.hpp"

#include <filesystem>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "store/store.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::make_database;
using landmarkdb::testing::make_record;
using landmarkdb::testing::TemporaryFolder;
using ::testing::HasSubstr;

class ServerStateTest : public ::testing::Test {
 protected:
  ServerStateTest() { make_database(db); }
  TemporaryFolder folder;
  const std::string db = folder.file("places.db");
  ServerState state{db};
};

TEST_F(ServerStateTest, IsUnavailableUntilLoaded) {
  EXPECT_EQ(state.health().phase, Phase::kStarting);
  EXPECT_THROW(state.served(), Error);
  state.reload({});
  EXPECT_EQ(state.health().phase, Phase::kServing);
  EXPECT_EQ(state.served()->scenes, 1U);
}

TEST_F(ServerStateTest, LeavesQueriesInFlightTheirCatalogue) {
  const auto before = state.reload({});
  Store::open_read_write(db).insert(make_record("second", 2), {});
  const auto after = state.reload({});
  EXPECT_EQ(before->localizer->catalog().entries.size(), 1U);
  EXPECT_EQ(after->localizer->catalog().entries.size(), 2U);
  EXPECT_EQ(state.served(), after);
  EXPECT_EQ(before->localizer->catalog().entries[0].record,
            after->localizer->catalog().entries[0].record)
      << "a scene that has not changed is not read again";
}

TEST_F(ServerStateTest, BuildsNothingNewWhenNothingChanged) {
  const auto before = state.reload({});
  EXPECT_EQ(state.reload({}), before);
}

TEST_F(ServerStateTest, KeepsServingWhenAReloadFails) {
  const auto before = state.reload({});
  std::filesystem::rename(db, folder.file("moved.db"));
  EXPECT_THROW(state.reload({}), Error);
  EXPECT_EQ(state.served(), before);
  EXPECT_EQ(state.health().phase, Phase::kServing);
  ASSERT_EQ(state.health().problems.size(), 1U);
  EXPECT_THAT(state.health().problems[0], HasSubstr("the last reload failed"));

  std::filesystem::rename(folder.file("moved.db"), db);
  state.reload({});
  EXPECT_TRUE(state.health().problems.empty());
}

TEST_F(ServerStateTest, SaysWhyItServesNothing) {
  ServerState other(folder.file("missing.db"));
  EXPECT_THROW(other.reload({}), Error);
  EXPECT_EQ(other.health().phase, Phase::kFailed);
  EXPECT_THAT(other.health().problems.at(0), HasSubstr("could not be loaded"));
  other.set_stopping();
  EXPECT_EQ(other.health().phase, Phase::kStopping);
}

}  // namespace
}  // namespace landmarkdb
