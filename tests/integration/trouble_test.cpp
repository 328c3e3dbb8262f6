#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/cloud/write_cloud.hpp"
#include "tests/integration/site.hpp"

namespace landmarkdb::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

// A view with so many points that its query runs long enough to be interrupted.
std::string long_view() {
  const std::string path = site().folder / "long.ply";
  ViewOptions options;
  options.camera = {.width = 1280, .height = 960, .fx = 1040, .fy = 1040, .cx = 640, .cy = 480};
  write_cloud(path, view_of(site().room, make_view_pose(site().room, 1), options));
  return path;
}

// Waits until the server works on a query (or on none); the request for the figures counts itself.
bool wait_until(const ServerProcess& server, bool busy) {
  const auto give_up = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < give_up) {
    const Outcome stats = server.client({"--json", "stats"});
    if (stats.status == 0 && (stats.json()["in_flight"].get<int>() > 1) == busy) return true;
  }
  return false;
}

TEST(Client, SaysThatTheServerDiedInMidQuery) {
  ServerProcess server(site().db, {"--threads", "1"});
  Running query("landmarkdb", {"--server", server.address(), "query", long_view()});
  ASSERT_TRUE(wait_until(server, true));
  server.process().signal(SIGKILL);
  const Outcome outcome = query.wait();
  EXPECT_EQ(outcome.status, 8) << outcome.out;
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("closed the connection before it answered"));
}

TEST(Client, CancelsItsQueryOnCtrlC) {
  ServerProcess server(site().db, {"--threads", "1"});
  Running query("landmarkdb", {"--server", server.address(), "query", long_view()});
  ASSERT_TRUE(wait_until(server, true));
  query.signal(SIGINT);
  const Outcome outcome = query.wait(std::chrono::seconds(10));
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_TRUE(wait_until(server, false));
  EXPECT_EQ(server.client({"health"}).status, 0);
}

TEST(Client, EndsAtItsDeadline) {
  ServerProcess server(site().db, {"--threads", "1"});
  const Outcome outcome = server.client({"--timeout", "0.05", "--json", "query", long_view()});
  EXPECT_EQ(outcome.status, 8) << outcome.out;
  EXPECT_EQ(outcome.json()["error"]["code"], "DEADLINE_EXCEEDED");
  EXPECT_TRUE(wait_until(server, false));
}

TEST(Client, SaysThatThereIsNoServer) {
  const TempFolder folder;
  const Outcome tcp = run("landmarkdb", {"--server", "127.0.0.1:1", "stats"});
  EXPECT_EQ(tcp.status, 8);
  EXPECT_THAT(tcp.err, HasSubstr("127.0.0.1:1"));
  const Outcome unix_socket =
      run("landmarkdb", {"--server", "unix:" + (folder / "no.sock"), "--json", "stats"});
  EXPECT_EQ(unix_socket.status, 8);
  EXPECT_EQ(unix_socket.json()["error"]["code"], "UNAVAILABLE");
}

TEST(Server, StopsWhenTwoSignalsComeAtOnce) {
  ServerProcess server(site().db);
  Running& process = server.process();
  process.signal(SIGSTOP);  // both wait for it
  process.signal(SIGINT);
  process.signal(SIGTERM);
  process.signal(SIGCONT);
  const Outcome outcome = process.wait(std::chrono::seconds(30));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(Server, SaysThatThePortIsBusy) {
  ServerProcess first(site().db);
  const Outcome second = run("landmarkdb-server", {"--db", site().db, "--listen", first.address()});
  EXPECT_EQ(second.status, 8);
  EXPECT_THAT(second.err, HasSubstr(first.address()));
  EXPECT_EQ(first.client({"health"}).status, 0);
}

TEST(Server, StopsOnSigtermAndTakesItsUnixSocketAway) {
  const TempFolder folder;
  const std::string path = folder / "landmarkdb.sock";
  ServerProcess server(site().db, {}, path);
  EXPECT_EQ(server.address(), "unix:" + path);
  EXPECT_EQ(server.client({"scene", "list"}).status, 0);
  const Outcome outcome = server.stop();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Server, StopsOnSigtermWhileItWorks) {
  ServerProcess server(site().db, {"--threads", "1"});
  Running query("landmarkdb", {"--server", server.address(), "query", long_view()});
  ASSERT_TRUE(wait_until(server, true));
  const Outcome stopped = server.stop();
  EXPECT_EQ(stopped.status, 0) << stopped.err;
  EXPECT_THAT(query.wait().status, ::testing::AnyOf(0, 3, 4, 8));
}

TEST(Server, LeavesTheDatabasesBytesAlone) {
  const auto bytes = [] {
    std::ifstream file(site().db, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string before = bytes();
  {
    ServerProcess server(site().db);
    const Eigen::Isometry3d T = make_view_pose(site().room, 1);
    server.client({"query", site().view("bytes", site().room, T)});
    server.client({"scene", "list"});
    EXPECT_EQ(server.stop().status, 0);
  }
  EXPECT_EQ(bytes(), before);
}

TEST(Server, RefusesWhatIsNoDatabase) {
  const TempFolder folder;
  const std::string text = folder / "text.db";
  std::ofstream(text)
      << "This is a text, and a text it shall remain, whoever opens it as a file.\n";
  const Outcome outcome = run("landmarkdb-server", {"--db", text, "--listen", "127.0.0.1:0"});
  EXPECT_THAT(outcome.status, ::testing::AnyOf(5, 7)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("text.db"));
  const Outcome missing =
      run("landmarkdb-server", {"--db", folder / "none.db", "--listen", "127.0.0.1:0"});
  EXPECT_NE(missing.status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.db"));
}

// Clouds that no program may take, whichever way they come in.
class BadCloud : public ::testing::TestWithParam<const char*> {
 protected:
  static std::string written(const TempFolder& folder, const std::string& kind) {
    const std::string path = folder / (kind + ".ply");
    const auto ply = [](const std::string& count, const std::string& body) {
      return "ply\nformat ascii 1.0\nelement vertex " + count +
             "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + body;
    };
    std::string text;
    if (kind == "empty") text = "";
    if (kind == "noise") text = std::string("\x01\x02\xff\xfe\x00garbage", 12);
    if (kind == "truncated") text = ply("1000", "0 0 0\n1 1 1\n");
    if (kind == "lying") text = ply("1000000000000", "0 0 0\n");
    if (kind == "no_points") text = ply("0", "");
    if (kind == "one_point") text = ply("1", "1 2 3\n");
    if (kind == "three_points") text = ply("3", "0 0 0\n1 0 0\n0 1 0\n");
    if (kind == "all_nan") text = ply("4", "nan nan nan\nnan 0 0\n0 nan 0\n0 0 nan\n");
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
};

TEST_P(BadCloud, IsRefusedByTheClientWithItsName) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "room", make_small_room(1)).status, 0);
  ServerProcess server(db);
  const Outcome outcome = server.client({"--json", "query", written(folder, GetParam())});
  EXPECT_EQ(outcome.status, 7) << outcome.out << outcome.err;
  EXPECT_TRUE(outcome.json().contains("error"));
  EXPECT_EQ(server.client({"health"}).status, 0);
}

TEST_P(BadCloud, IsRefusedByTheIndexerAndLeavesNoScene) {
  const TempFolder folder;
  const std::string db = folder / "fresh.db";
  const Outcome outcome =
      run("landmarkdb-indexer", {"--db", db, "add", "bad", written(folder, GetParam())});
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::Not(::testing::IsEmpty()));
}

TEST_P(BadCloud, IsRefusedOverTheSocketToo) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "room", make_small_room(1)).status, 0);
  ServerProcess server(db);
  const Outcome outcome = server.client({"scene", "add", "bad", written(folder, GetParam())});
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(server.client({"scene", "show", "bad"}).status, 3);
}

INSTANTIATE_TEST_SUITE_P(Kinds,
                         BadCloud,
                         ::testing::Values("empty",
                                           "noise",
                                           "truncated",
                                           "lying",
                                           "no_points",
                                           "one_point",
                                           "three_points",
                                           "all_nan"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST(CoplanarCloud, IsNoPlaceAndNeverLocalized) {
  const TempFolder folder;
  PointCloud wall;
  for (int i = 0; i < 10'000; ++i) {
    wall.points.emplace_back(
        0.02F * static_cast<float>(i % 100), 0.02F * static_cast<float>(i / 100), 2.0F);
  }
  const std::string path = folder / "wall.ply";
  write_cloud(path, wall);
  EXPECT_EQ(run("landmarkdb-indexer", {"--db", folder / "w.db", "add", "wall", path}).status, 7);
  ServerProcess server(site().db);
  EXPECT_THAT(server.client({"query", path}).status, ::testing::AnyOf(3, 4, 7));
}

TEST(Programs, EndWith2OnWrongUsage) {
  for (const char* program : {"landmarkdb", "landmarkdb-indexer", "landmarkdb-server"}) {
    const Outcome outcome = run(program, {"--no-such-option"});
    EXPECT_EQ(outcome.status, 2) << program;
    EXPECT_THAT(outcome.err, HasSubstr("--help")) << program;
    EXPECT_EQ(run(program, {"--help"}).status, 0) << program;
    EXPECT_THAT(run(program, {"--version"}).out, HasSubstr("protocol version")) << program;
  }
}

TEST(Programs, PrintCompletionsForThreeShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = run("landmarkdb", {"completion", shell});
    EXPECT_EQ(outcome.status, 0) << shell;
    EXPECT_THAT(outcome.out, HasSubstr("min-confidence")) << shell;
  }
}

}  // namespace
}  // namespace landmarkdb::testing
