#pragma once

#include <exception>
#include <string>

#include <boost/asio/io_context.hpp>

#include "server/log.hpp"

namespace landmarkdb {

// Runs the handlers of `io` until there is no work left. One that throws is named in the log, and
// the others are served on. Many threads may call it at once.
inline void run_io(boost::asio::io_context& io, Logger& log) {
  while (true) {
    try {
      io.run();
      return;
    } catch (const std::exception& error) {
      log.write(LogLevel::kError, "a handler failed", {{"reason", std::string(error.what())}});
    } catch (...) {
      log.write(LogLevel::kError, "a handler failed");
    }
  }
}

}  // namespace landmarkdb
