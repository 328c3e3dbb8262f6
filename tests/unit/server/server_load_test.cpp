// Many clients at once, some of whom vanish.

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::make_blob;
using landmarkdb::testing::make_view;
using landmarkdb::testing::query_envelope;
using landmarkdb::testing::RunningServer;
using landmarkdb::testing::TestClient;

TEST(ServerUnderLoad, AnswersEverybodyTheSameWhileOthersVanishAndCataloguesChange) {
  RunningServer running({.threads = 2});
  const v1::Envelope query = query_envelope(1, make_view());
  v1::QueryResult expected = running.client().call(query).query_result();
  const auto essence = [](v1::QueryResult result) {
    result.clear_timing();
    result.clear_generation();
    return result.SerializeAsString();
  };

  std::atomic<int> right{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      TestClient client = running.client();
      for (int i = 0; i < 3; ++i) {
        if (essence(client.call(query).query_result()) == essence(expected)) ++right;
      }
    });
  }
  threads.emplace_back([&] {
    for (int i = 0; i < 10; ++i) {
      TestClient client = running.client();
      client.send(query);
      client.reset();  // killed in the middle of its query
    }
  });
  threads.emplace_back([&] {
    TestClient client = running.client();
    for (std::uint64_t id = 1; id <= 4; ++id) {
      v1::Envelope reload;
      reload.set_request_id(id);
      reload.mutable_reload();
      EXPECT_TRUE(client.call(reload).has_reload_reply());
    }
  });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 12);
}

TEST(ServerUnderLoad, StopsWhileClientsKeepComing) {
  RunningServer running({.threads = 2, .stop_cancel_after = std::chrono::milliseconds(50)});
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      while (!done) {
        try {
          TestClient client = running.client();
          for (std::uint64_t id = 1; id <= 3; ++id) client.send(query_envelope(id, make_blob()));
          client.closed_by_server(std::chrono::milliseconds(20));
        } catch (const std::exception&) {  // refused: the server is stopping
        }
      }
    });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  running.server->stop();
  running.server->wait();
  done = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_THROW(running.client(), std::exception);
}

}  // namespace
}  // namespace landmarkdb
