#include "bench/load/run_clients.hpp"

#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "client/client.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBackOff{50};  // after a refusal

RequestOutcome outcome_of(const Error& error) {
  return error.code() == ErrorCode::kResourceExhausted ? RequestOutcome::kRefused
                                                       : RequestOutcome::kFailed;
}

// One client's questions; `first` is the cloud it starts with.
std::vector<Request> ask_in_turn(const ClientsOptions& options,
                                 std::span<const PointCloud> clouds,
                                 std::size_t first,
                                 Clock::time_point end) {
  const client::ConnectOptions connect{.server = options.server, .token = options.token};
  std::optional<client::Client> client(std::in_place, connect, RunContext{});
  std::vector<Request> requests;
  for (std::size_t i = first; Clock::now() < end; ++i) {
    const std::vector<QueryCloud> question{{clouds[i % clouds.size()]}};
    Request request;
    const auto sent = Clock::now();
    try {
      if (!client) client.emplace(connect, RunContext{});
      client->query(question, {}, {});
    } catch (const Error& error) {
      request.outcome = outcome_of(error);
      if (error.code() == ErrorCode::kUnavailable) client.reset();
    }
    request.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - sent).count();
    requests.push_back(request);
    std::this_thread::sleep_for(request.outcome == RequestOutcome::kAnswered ? options.pause
                                                                             : kBackOff);
  }
  return requests;
}

}  // namespace

std::vector<Request> run_clients(const ClientsOptions& options,
                                 std::span<const PointCloud> clouds,
                                 Clock::time_point end) {
  const auto count = static_cast<std::size_t>(options.clients);
  std::vector<std::vector<Request>> seen(count);
  std::vector<std::exception_ptr> failures(count);
  {
    std::vector<std::jthread> threads;
    for (std::size_t c = 0; c < count; ++c) {
      threads.emplace_back([&, c] {
        try {
          seen[c] = ask_in_turn(options, clouds, c, end);
        } catch (...) {
          failures[c] = std::current_exception();
        }
      });
    }
  }
  std::vector<Request> all;
  for (std::size_t c = 0; c < count; ++c) {
    if (failures[c]) std::rethrow_exception(failures[c]);
    all.insert(all.end(), seen[c].begin(), seen[c].end());
  }
  return all;
}

}  // namespace landmarkdb::bench
