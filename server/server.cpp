#include "server/server.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <thread>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <google/protobuf/stubs/logging.h>

#include "engine/base/error.hpp"
#include "server/dispatcher.hpp"
#include "server/listener.hpp"
#include "server/run_io.hpp"
#include "server/session.hpp"
#include "store/store.hpp"

namespace landmarkdb {

namespace {

using boost::system::error_code;

// Parsing a large request keeps a thread for some 20 ms; with two, others are not held up by it.
constexpr int kSocketThreads = 2;
// Connections before Hello, each some 70 KB: enough for a crowd that comes at once, 18 MB in all.
constexpr std::size_t kMaxStrangers = 256;
constexpr std::chrono::milliseconds kStopPoll{10};

ServerOptions completed(ServerOptions options) {
  if (options.threads <= 0) {
    options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  if (options.max_message_bytes < kMaxHelloBytes ||
      options.max_message_bytes > kLargestMessageBytes) {
    throw Error(ErrorCode::kInvalidArgument,
                "a message limit of " + std::to_string(options.max_message_bytes) +
                    " bytes cannot be, want " + std::to_string(kMaxHelloBytes) + " to " +
                    std::to_string(kLargestMessageBytes),
                "--max-message");
  }
  options.memory_budget_bytes = std::max(options.memory_budget_bytes, options.max_message_bytes);
  if (options.max_connections == 0) {
    throw Error(ErrorCode::kInvalidArgument, "want at least one connection", "--max-connections");
  }
  if (options.max_strangers == 0) {
    options.max_strangers = std::max(kMaxStrangers, options.max_connections);
  }
  if (options.deadline.count() <= 0) {
    throw Error(ErrorCode::kInvalidArgument, "want a deadline above 0", "--deadline");
  }
  return options;
}

void write_port_file(const std::string& path, std::uint16_t port) {
  // Written beside and renamed: whoever waits for the file never reads half a number.
  const std::string draft = path + ".new";
  std::ofstream file(draft);
  file << port << '\n';
  file.close();
  if (!file || std::rename(draft.c_str(), path.c_str()) != 0) {
    throw Error(ErrorCode::kInvalidArgument, path + ": cannot be written", "--port-file");
  }
}

}  // namespace

struct Server::State {
  State(const ServerOptions& given, Logger& logger)
      : options(completed(given)), log(logger), state(options.db, localizer_options()) {
    const Store store = Store::open_read_only(options.db);
    for (const std::string& warning : store.warnings()) log.write(LogLevel::kWarning, warning);
    if (options.listen != "none") {
      listeners.push_back(
          listen_tcp(control, options.listen, options.allow_insecure || !options.token.empty()));
      port = listeners.back()->port();
    }
    if (!options.unix_path.empty()) listeners.push_back(listen_unix(control, options.unix_path));
    if (listeners.empty()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "there is nothing to listen on: give --listen or --unix",
                  "--listen");
    }
    for (const auto& listener : listeners) addresses.push_back(listener->address());
    if (!options.port_file.empty()) write_port_file(options.port_file, port);
  }

  LocalizerOptions localizer_options() {
    LocalizerOptions localizer;
    localizer.scene_memory_bytes = options.scene_memory_bytes;
    localizer.on_damaged = [this](const CatalogEntry& entry, const std::string& what) {
      log.write(
          LogLevel::kError, "scene left out", {{"scene", entry.record->name}, {"reason", what}});
    };
    return localizer;
  }
  void load(bool first);
  void accept(Connection::Socket socket, std::string peer);
  SessionEvents events_of(std::uint64_t id);
  void wait_for_signal();
  void begin_stop();
  void watch_stop();
  void cut_all();

  const ServerOptions options;
  Logger& log;
  ServerState state;
  Counters counters;
  MemoryBudget budget{options.memory_budget_bytes};

  boost::asio::io_context io{kSocketThreads};
  Strand control = boost::asio::make_strand(io);  // guards what is below but the queues
  std::optional<boost::asio::executor_work_guard<boost::asio::io_context::executor_type>> work{
      boost::asio::make_work_guard(io)};
  std::vector<std::unique_ptr<Listener>> listeners;
  std::vector<std::string> addresses;
  std::uint16_t port = 0;
  std::map<std::uint64_t, std::shared_ptr<Session>> sessions;
  std::set<std::uint64_t> strangers;  // sessions that have not said Hello; the oldest first
  std::uint64_t next_session = 1;
  boost::asio::signal_set signals{control};
  boost::asio::steady_timer stop_timer{control};
  bool stopping = false;
  bool stopped = false;  // nothing is waited for any more
  bool cancelled = false;
  std::chrono::steady_clock::time_point stop_began;

  WorkQueue::OnFailure on_failure = [this](const std::string& what) {
    log.write(LogLevel::kError, "a task failed", {{"reason", what}});
  };
  WorkQueue compute{options.threads, options.max_waiting_queries, on_failure};
  WorkQueue writes{1, options.max_waiting_writes, on_failure};
  RequestHandler handler{options, state, counters, compute, budget};
  Dispatcher dispatcher{handler, compute, writes, counters, log, options.threads};
  SessionServices services{options, dispatcher, state, budget, counters, log};
  std::vector<std::thread> threads;
};

void Server::State::load(bool first) {
  const bool queued = writes.post([this, first] {
    const auto start = std::chrono::steady_clock::now();
    RunContext context;
    context.stop = state.stop_token();
    context.threads = first ? options.threads : std::max(1, options.threads / 2);
    try {
      const std::shared_ptr<const Served> served = state.reload(context);
      ++counters.reloads_total;
      for (const DamagedScene& scene : served->unreadable) {
        log.write(
            LogLevel::kError, "scene left out", {{"scene", scene.name}, {"reason", scene.what}});
      }
      for (const DamagedModel& model : served->damaged_models) {
        log.write(
            LogLevel::kError, "model left out", {{"model", model.name}, {"reason", model.what}});
      }
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - start;
      log.write(LogLevel::kInfo,
                "database loaded",
                {{"scenes", served->scenes},
                 {"models", served->models->entries.size()},
                 {"generation", served->generation},
                 {"total_ms", took.count()}});
    } catch (const std::exception& error) {
      log.write(LogLevel::kError, "database not loaded", {{"reason", std::string(error.what())}});
    }
  });
  if (!queued) log.write(LogLevel::kWarning, "reload left out: too many changes are waiting");
}

void Server::State::accept(Connection::Socket socket, std::string peer) {
  ++counters.connections_total;
  if (stopping) return;
  if (strangers.size() >= options.max_strangers) {
    const auto oldest = strangers.begin();
    ++counters.rejected_total;
    sessions.at(*oldest)->make_room();
    strangers.erase(oldest);
  }
  const std::uint64_t id = next_session++;
  auto session =
      std::make_shared<Session>(std::move(socket), id, std::move(peer), services, events_of(id));
  strangers.insert(id);
  sessions[id] = session;
  counters.connections = sessions.size();
  session->start();
}

SessionEvents Server::State::events_of(std::uint64_t id) {
  return {
      .on_greeted = [this, id] { boost::asio::post(control, [this, id] { strangers.erase(id); }); },
      .on_closed =
          [this, id] {
            boost::asio::post(control, [this, id] {
              strangers.erase(id);
              sessions.erase(id);
              counters.connections = sessions.size();
            });
          }};
}

void Server::State::wait_for_signal() {
  signals.async_wait([this](const error_code& error, int number) {
    if (error || stopped) return;
    wait_for_signal();  // before begin_stop(), which may cancel this wait
    if (number == SIGHUP) {
      log.write(LogLevel::kInfo, "reload on SIGHUP");
      load(false);
    } else if (stopping) {
      cut_all();
    } else {
      log.write(LogLevel::kInfo, number == SIGTERM ? "stop on SIGTERM" : "stop on SIGINT");
      begin_stop();
    }
  });
}

void Server::State::begin_stop() {
  if (stopping) return;
  stopping = true;
  stop_began = std::chrono::steady_clock::now();
  state.set_stopping();
  for (const auto& listener : listeners) listener->close();
  for (const auto& [id, session] : sessions) session->go_away("the server is stopping");
  watch_stop();
}

// Until the last connection is gone.
void Server::State::watch_stop() {
  if (sessions.empty()) {
    error_code ignored;
    stopped = true;  // a second signal may be on its way, which the cancelling does not reach
    signals.cancel(ignored);
    work.reset();
    return;
  }
  const auto elapsed = std::chrono::steady_clock::now() - stop_began;
  if (elapsed >= options.stop_cut_after) {
    cut_all();
  } else if (!cancelled && elapsed >= options.stop_cancel_after) {
    cancelled = true;
    for (const auto& [id, session] : sessions) session->cancel_requests();
  }
  stop_timer.expires_after(kStopPoll);
  stop_timer.async_wait([this](const error_code& error) {
    if (!error) watch_stop();
  });
}

void Server::State::cut_all() {
  for (const auto& [id, session] : sessions) session->close_now();
}

Server::Server(const ServerOptions& options, Logger& log)
    : state_(std::make_unique<State>(options, log)) {
  // Protobuf would print a line for each malformed message; ours go through the log.
  google::protobuf::SetLogHandler(nullptr);
}

Server::~Server() {
  stop();
  if (state_->threads.empty()) {
    for (const auto& listener : state_->listeners) listener->close();
  }
  wait();
}

void Server::start() {
  State& s = *state_;
  for (const auto& listener : s.listeners) {
    listener->start([&s](Connection::Socket socket, std::string peer) {
      try {
        s.accept(std::move(socket), std::move(peer));
      } catch (const std::exception& error) {  // this one is lost, the next may be served
        s.log.write(LogLevel::kError, "connection lost", {{"reason", std::string(error.what())}});
      }
    });
  }
  for (int i = 0; i < kSocketThreads; ++i) s.threads.emplace_back([&s] { run_io(s.io, s.log); });
  s.load(true);
}

void Server::stop_on_signals() {
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) state_->signals.add(number);
  state_->wait_for_signal();
}

void Server::stop() {
  boost::asio::post(state_->control, [s = state_.get()] { s->begin_stop(); });
}

void Server::reload() { state_->load(false); }

void Server::wait() {
  for (std::thread& thread : state_->threads) {
    if (thread.joinable()) thread.join();
  }
  state_->compute.join();
  state_->writes.join();
}

std::vector<std::string> Server::addresses() const { return state_->addresses; }

std::uint16_t Server::port() const { return state_->port; }

}  // namespace landmarkdb
