#include "server/request_handler.hpp"

#include <stop_token>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "store/store.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::make_blob;
using landmarkdb::testing::make_database;
using landmarkdb::testing::make_record;
using landmarkdb::testing::make_view;
using landmarkdb::testing::query_envelope;
using landmarkdb::testing::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class RequestHandlerTest : public ::testing::Test {
 protected:
  RequestHandlerTest() {
    options.db = folder.file("places.db");
    make_database(options.db);
    options.threads = 1;
  }

  v1::Envelope ask(const v1::Envelope& request) {
    RequestHandler handler(options, state(), counters, queue, memory);
    return handler.handle(request, context);
  }
  ServerState& state() {
    if (!state_) state_ = std::make_unique<ServerState>(options.db);
    return *state_;
  }
  static v1::Envelope request() {
    v1::Envelope envelope;
    envelope.set_request_id(7);
    return envelope;
  }

  TemporaryFolder folder;
  ServerOptions options;
  Counters counters;
  WorkQueue queue{1, 1};
  MemoryBudget memory{std::size_t{64} * 1024 * 1024};
  RunContext context;

 private:
  std::unique_ptr<ServerState> state_;
};

TEST_F(RequestHandlerTest, AnswersAQueryWithAChainThatMultipliesOut) {
  state().reload(context);
  const v1::Envelope reply = ask(query_envelope(7, make_view()));
  ASSERT_TRUE(reply.has_query_result()) << reply.DebugString();
  EXPECT_EQ(reply.request_id(), 7U);
  const v1::QueryResult& result = reply.query_result();
  EXPECT_GT(result.generation(), 0U);
  EXPECT_GT(result.query().points_used(), 0U);
  EXPECT_GT(result.timing().total_ms(), 0.0);
  for (const v1::Hypothesis& h : result.hypotheses()) {
    const auto matrix = [](const google::protobuf::RepeatedField<double>& numbers) {
      EXPECT_EQ(numbers.size(), 16);
      return Eigen::Matrix4d(
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data()));
    };
    const Eigen::Matrix4d product = matrix(h.chain().t_icp()) *
                                    matrix(h.chain().t_scene_landmark()) *
                                    matrix(h.chain().t_landmark_sensor());
    EXPECT_LT((product - matrix(h.t_scene_sensor())).norm(), 1e-9);
    EXPECT_THAT(h.covariance(), SizeIs(36));
    EXPECT_THAT(h.rotation_xyzw(), SizeIs(4));
    EXPECT_EQ(h.scene(), "room");
  }
}

TEST_F(RequestHandlerTest, SaysNotFoundForACloudThatIsNowhere) {
  state().reload(context);
  const v1::Envelope reply = ask(query_envelope(7, make_blob()));
  ASSERT_TRUE(reply.has_query_result()) << reply.DebugString();
  EXPECT_EQ(reply.query_result().status(), v1::QUERY_STATUS_NOT_FOUND);
  EXPECT_FALSE(reply.query_result().reason().empty());
}

TEST_F(RequestHandlerTest, IsUnavailableUntilTheDatabaseIsLoaded) {
  const v1::Envelope reply = ask(query_envelope(7, make_blob()));
  EXPECT_EQ(reply.error().code(), v1::CODE_UNAVAILABLE);
  EXPECT_THAT(reply.error().message(), HasSubstr("being loaded"));
  EXPECT_GT(reply.error().retry_after_ms(), 0U);

  v1::Envelope health = request();
  health.mutable_health();
  EXPECT_EQ(ask(health).health_reply().status(), v1::HEALTH_STATUS_STARTING);
  EXPECT_FALSE(ask(health).health_reply().ready());
}

TEST_F(RequestHandlerTest, TurnsWhatIsThrownIntoAnErrorWithItsField) {
  state().reload(context);
  v1::Envelope query = query_envelope(7, make_blob());
  query.mutable_query()->mutable_options()->set_ratio(3.0);
  const v1::Envelope reply = ask(query);
  EXPECT_EQ(reply.request_id(), 7U);
  EXPECT_EQ(reply.error().code(), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(reply.error().field(), "options.ratio");
}

TEST_F(RequestHandlerTest, RefusesMessagesThatAreNoRequest) {
  EXPECT_EQ(ask(request()).error().code(), v1::CODE_UNIMPLEMENTED);
  v1::Envelope answer = request();
  answer.mutable_query_result();
  EXPECT_EQ(ask(answer).error().code(), v1::CODE_INVALID_ARGUMENT);
}

TEST_F(RequestHandlerTest, StopsBeforeItBeginsWhenToldTo) {
  std::stop_source stop;
  stop.request_stop();
  context.stop = stop.get_token();
  EXPECT_EQ(ask(query_envelope(7, make_blob())).error().code(), v1::CODE_CANCELLED);
  context = {};
  context.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_EQ(ask(query_envelope(7, make_blob())).error().code(), v1::CODE_DEADLINE_EXCEEDED);
}

TEST_F(RequestHandlerTest, ListsAndShowsScenes) {
  state().reload(context);
  v1::Envelope list = request();
  list.mutable_scene_list();
  const v1::Envelope reply = ask(list);
  ASSERT_THAT(reply.scene_list_reply().scenes(), SizeIs(1)) << reply.DebugString();
  EXPECT_EQ(reply.scene_list_reply().scenes(0).name(), "room");

  v1::Envelope show = request();
  show.mutable_scene_show()->set_name("room");
  const v1::SceneInfo info = ask(show).scene_reply().scene();
  EXPECT_THAT(info.versions(), SizeIs(1));
  EXPECT_GT(info.keypoints(), 0U);
  EXPECT_LT(info.min_m().x(), info.max_m().x());
  EXPECT_EQ(info.state(), v1::SCENE_STATE_ACTIVE);

  show.mutable_scene_show()->set_name("cellar");
  EXPECT_EQ(ask(show).error().code(), v1::CODE_NOT_FOUND);
}

TEST_F(RequestHandlerTest, RefusesChangesOnAReadOnlyServer) {
  state().reload(context);
  options.read_only = true;
  const std::string before = landmarkdb::testing::bytes_of_file(options.db);
  std::vector<v1::Envelope> changes(7, request());
  changes[0].mutable_scene_remove()->set_name("room");
  changes[1].mutable_scene_rename()->set_old_name("room");
  changes[2].mutable_scene_add()->set_name("other");
  changes[3].mutable_scene_rollback()->set_name("room");
  changes[4].mutable_scene_tag()->set_name("room");
  changes[5].mutable_landmark_add()->set_scene("room");
  changes[6].mutable_landmark_remove()->set_scene("room");
  for (const v1::Envelope& change : changes) {
    EXPECT_EQ(ask(change).error().code(), v1::CODE_PERMISSION_DENIED) << request_name(change);
  }
  EXPECT_EQ(landmarkdb::testing::bytes_of_file(options.db), before);
}

TEST_F(RequestHandlerTest, PutsChangesInService) {
  state().reload(context);
  const std::uint64_t before = state().served()->generation;
  v1::Envelope rename = request();
  rename.mutable_scene_rename()->set_old_name("room");
  rename.mutable_scene_rename()->set_new_name("hall");
  EXPECT_EQ(ask(rename).scene_reply().scene().name(), "hall");
  EXPECT_GT(state().served()->generation, before);
  EXPECT_EQ(state().served()->localizer->catalog().entries.at(0).record->name, "hall");

  v1::Envelope tag = request();
  tag.mutable_scene_tag()->set_name("hall");
  (*tag.mutable_scene_tag()->mutable_tags())["floor"] = "2";
  EXPECT_EQ(ask(tag).scene_reply().scene().tags().at("floor"), "2");

  v1::Envelope mark = request();
  mark.mutable_landmark_add()->set_scene("hall");
  mark.mutable_landmark_add()->mutable_landmark()->set_name("door");
  mark.mutable_landmark_add()->mutable_landmark()->mutable_max_m()->set_x(1);
  EXPECT_EQ(ask(mark).error().code(), v1::CODE_INVALID_ARGUMENT) << "the box has no volume";
  mark.mutable_landmark_add()->mutable_landmark()->mutable_max_m()->set_y(1);
  mark.mutable_landmark_add()->mutable_landmark()->mutable_max_m()->set_z(1);
  EXPECT_THAT(ask(mark).scene_reply().scene().landmarks(), SizeIs(1));

  v1::Envelope remove = request();
  remove.mutable_scene_remove()->set_name("hall");
  EXPECT_TRUE(ask(remove).has_scene_remove_reply());
  EXPECT_EQ(state().served()->scenes, 0U);
  EXPECT_EQ(ask(remove).error().code(), v1::CODE_NOT_FOUND);
}

// A stop used to wait for the whole catalogue to be built again.
TEST_F(RequestHandlerTest, BuildsNoCatalogueForAServerThatStops) {
  state().reload(context);
  state().set_stopping();
  v1::Envelope tag = request();
  tag.mutable_scene_tag()->set_name("room");
  (*tag.mutable_scene_tag()->mutable_tags())["floor"] = "2";
  const v1::Envelope reply = ask(tag);
  EXPECT_EQ(reply.error().code(), v1::CODE_CANCELLED);
  EXPECT_THAT(reply.error().message(), HasSubstr("the change is stored"));
  EXPECT_EQ(Store::open_read_only(options.db).show("room").tags.at("floor"), "2");
}

TEST_F(RequestHandlerTest, ReloadFindsWhatAnotherProgramHasAdded) {
  state().reload(context);
  Store::open_read_write(options.db).insert(make_record("second", 2), {});
  v1::Envelope reload = request();
  reload.mutable_reload();
  EXPECT_EQ(ask(reload).reload_reply().scenes(), 2U);
}

TEST_F(RequestHandlerTest, CountsWhatItAnswered) {
  state().reload(context);
  ask(query_envelope(7, make_blob()));
  v1::Envelope stats = request();
  stats.mutable_stats();
  const v1::StatsReply reply = ask(stats).stats_reply();
  EXPECT_EQ(reply.queries_not_found(), 1U);
  EXPECT_EQ(reply.scenes(), 1U);
  EXPECT_GT(reply.points(), 0U);
  EXPECT_GT(reply.resident_bytes(), 0U);
  EXPECT_GT(reply.database_bytes(), 0U);
}

}  // namespace
}  // namespace landmarkdb
