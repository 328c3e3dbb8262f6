#include "client/render_server.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(StatsText, CountsScenesAndQueries) {
  Stats stats;
  stats.scenes = 1;
  stats.quarantined = 2;
  stats.queries_localized = 1'234;
  EXPECT_THAT(stats_text(stats),
              AllOf(HasSubstr("1 scene, 2 damaged and not served"), HasSubstr("1,234 localized")));
  EXPECT_EQ(stats_json(stats)["queries_localized"], 1'234);
}

TEST(HealthText, NamesProblemsAndDamagedScenes) {
  const Health health{
      .status = "degraded", .ready = true, .problems = {"disk slow"}, .quarantined = {"attic"}};
  EXPECT_THAT(health_text(health),
              AllOf(HasSubstr("degraded, ready\n"), HasSubstr("disk slow"), HasSubstr("attic")));
  EXPECT_EQ(health_json(health)["quarantined"][0], "attic");
}

TEST(ReloadText, SaysWhatIsServedNow) {
  const Reload reload{.generation = 7, .scenes = 3};
  EXPECT_EQ(reload_text(reload), "serving 3 scenes (generation 7)\n");
  EXPECT_EQ(reload_json(reload)["generation"], 7);
}

}  // namespace
}  // namespace landmarkdb::client
