#pragma once

#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace landmarkdb {

enum class LogLevel { kDebug, kInfo, kWarning, kError, kOff };

// "debug", "info", "warning", "error", "off".
std::string_view log_level_name(LogLevel level);
std::optional<LogLevel> log_level_from_name(std::string_view name);

struct LogField {
  std::string key;
  std::variant<std::string, double, std::uint64_t> value;
};

// One line an event: time (UTC), level, message, fields; as text or as one JSON object. Control
// characters are escaped, so that no name from the wire can forge a line. A line that cannot be
// written is lost: no request ends for want of a log. Thread-safe.
class Logger {
 public:
  // `out` must outlive the logger.
  Logger(std::ostream& out, LogLevel level, bool json) : out_(out), level_(level), json_(json) {}

  // Does not throw.
  void write(LogLevel level, std::string_view message, const std::vector<LogField>& fields = {});
  bool wants(LogLevel level) const { return level >= level_ && level_ != LogLevel::kOff; }

 private:
  std::string line(LogLevel level, std::string_view message, const std::vector<LogField>& fields);

  std::ostream& out_;
  LogLevel level_;
  bool json_;
  std::mutex mutex_;  // guards out_
};

}  // namespace landmarkdb
