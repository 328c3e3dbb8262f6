#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/log.hpp"
#include "server/options.hpp"

namespace landmarkdb {

// The whole server: listens, loads the database behind the scenes, answers, stops cleanly.
//
//   Server server(options, log);   // binds; throws when it cannot serve at all
//   server.start();
//   server.stop();                 // from any thread, or a signal after stop_on_signals()
//   server.wait();
//
// Public members may be called from any thread; wait() by one.
class Server {
 public:
  // Checks the options and the database file and binds the addresses, so that a caller knows at
  // once what does not work. Throws Error: kUnavailable for a busy address, kPermissionDenied for
  // one that others can reach without a token, what Store::open_read_only throws for the database.
  // `log` must outlive the server.
  Server(const ServerOptions& options, Logger& log);
  // Stops and waits.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Accepts clients and begins to load the database.
  void start();

  // From now on SIGTERM and SIGINT stop the server (a second one cuts all connections at once) and
  // SIGHUP reloads the database.
  void stop_on_signals();

  // Takes no more clients, says GoAway, lets open requests finish for a moment, then cancels them.
  void stop();
  // Reads the database again, in the background.
  void reload();
  // Returns once the server has stopped and nothing of it runs.
  void wait();

  // Where clients reach it: "127.0.0.1:7071", "unix:/run/x.sock".
  std::vector<std::string> addresses() const;
  std::uint16_t port() const;  // of TCP; 0 without

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb
