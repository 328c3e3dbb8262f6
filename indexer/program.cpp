#include "indexer/program.hpp"

#include <algorithm>
#include <iostream>
#include <thread>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "cli/usage_error.hpp"

namespace landmarkdb::indexer {

const std::string& Program::database() const {
  if (db.empty()) throw cli::UsageError("--db", "is required: the database file");
  return db;
}

int Program::thread_count() const {
  if (threads > 0) return threads;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void Program::print(const nlohmann::ordered_json& object, const std::string& text) const {
  if (json) {
    // File names need not be UTF-8; what is not comes out as U+FFFD.
    std::cout << object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  } else {
    std::cout << cli::printable_lines(text);
  }
}

void Program::note(const std::string& sentence) const {
  if (!quiet) std::cerr << cli::printable_lines(sentence) << '\n';
}

}  // namespace landmarkdb::indexer
