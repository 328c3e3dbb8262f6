#include "server/log.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <ostream>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"

namespace landmarkdb {

namespace {

constexpr std::array<std::string_view, 5> kLevelNames = {
    "debug", "info", "warning", "error", "off"};

std::string timestamp() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::array<char, 8> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%03dZ", static_cast<int>(ms));
  return std::string(text.data(), length) + fraction.data();
}

// A JSON string with its quotes, or the plain text where it needs none.
std::string quoted(const std::string& text, bool always) {
  bool plain = !text.empty();
  for (const char c : text) {
    if (c <= ' ' || c == '"' || c == '=' || c == '\\' || c == '\x7f') plain = false;
  }
  if (plain && !always) return text;
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string value_text(const LogField& field, bool json) {
  if (const auto* text = std::get_if<std::string>(&field.value)) return quoted(*text, json);
  if (const auto* count = std::get_if<std::uint64_t>(&field.value)) return std::to_string(*count);
  std::array<char, 64> number{};
  std::snprintf(number.data(), number.size(), "%.6g", std::get<double>(field.value));
  return json ? nlohmann::json(std::get<double>(field.value)).dump() : std::string(number.data());
}

// As quoted(), but text for people keeps its spaces.
std::string message_text(std::string_view message) {
  std::string text = quoted(std::string(message), true);
  return text.substr(1, text.size() - 2);
}

}  // namespace

std::string_view log_level_name(LogLevel level) {
  return kLevelNames.at(static_cast<std::size_t>(level));
}

std::optional<LogLevel> log_level_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kLevelNames.size(); ++i) {
    if (kLevelNames[i] == name) return static_cast<LogLevel>(i);
  }
  return std::nullopt;
}

std::string Logger::line(LogLevel level,
                         std::string_view message,
                         const std::vector<LogField>& fields) {
  std::string line;
  if (json_) {
    line = R"({"time":")" + timestamp() + R"(","level":")" + std::string(log_level_name(level)) +
           R"(","message":)" + quoted(std::string(message), true);
    for (const LogField& field : fields) {
      line += "," + quoted(field.key, true) + ":" + value_text(field, true);
    }
    return line + "}\n";
  }
  line = timestamp() + " " + std::string(log_level_name(level)) + " " + message_text(message);
  for (const LogField& field : fields) line += " " + field.key + "=" + value_text(field, false);
  return cli::printable(line) + "\n";
}

void Logger::write(LogLevel level, std::string_view message, const std::vector<LogField>& fields) {
  if (!wants(level)) return;
  try {
    const std::string text = line(level, message, fields);
    const std::lock_guard lock(mutex_);
    out_ << text << std::flush;
  } catch (const std::exception&) {
    // No memory, or a stream that throws: there is nobody left to tell.
  }
}

}  // namespace landmarkdb
