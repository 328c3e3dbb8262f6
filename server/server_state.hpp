#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/retrieval/localizer.hpp"
#include "store/model_types.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// One catalogue in service. Never changes; queries in flight keep theirs across a reload.
struct Served {
  std::shared_ptr<const Localizer> localizer;
  std::shared_ptr<const MonoCatalog> models;
  std::shared_ptr<const Recognizer> recognizer;  // of these models
  std::vector<DamagedScene> unreadable;          // scenes the catalogue had to leave out
  std::vector<DamagedModel> damaged_models;      // the same
  std::uint64_t generation = 0;
  std::uint64_t scenes = 0, points = 0, keypoints = 0;

  // All scenes that answer nothing for damage: those left out, and those set aside when they were
  // read for a query.
  std::vector<DamagedScene> damaged() const;
};

enum class Phase { kStarting, kServing, kFailed, kStopping };

struct Health {
  Phase phase = Phase::kStarting;
  std::vector<std::string> problems;
  std::vector<std::string> quarantined;  // names of scenes and models
};

// What all connections share about the database: the catalogue in service and how it is doing.
// Thread-safe.
class ServerState {
 public:
  // `localizer`: of each catalogue; what it says of damage is said to it from any thread.
  explicit ServerState(std::string db_path, LocalizerOptions localizer = {})
      : db_path_(std::move(db_path)), localizer_options_(std::move(localizer)) {}

  const std::string& db_path() const { return db_path_; }

  // The catalogue in service; Error{kUnavailable} while there is none.
  std::shared_ptr<const Served> served() const;
  // The same, null while there is none.
  std::shared_ptr<const Served> served_or_null() const;

  // Reads the database, builds a new catalogue beside the old one and puts it in service. One at a
  // time. On an error the old one stays, health tells why, and the error goes on to the caller.
  std::shared_ptr<const Served> reload(const RunContext& context);

  Health health() const;
  // The server ends: health says so, and who holds the token stops.
  void set_stopping();
  // Of work that belongs to no client.
  std::stop_token stop_token() const { return stop_source_.get_token(); }

 private:
  std::string db_path_;
  LocalizerOptions localizer_options_;
  std::stop_source stop_source_;
  std::mutex reload_mutex_;
  mutable std::mutex mutex_;  // guards all below
  std::shared_ptr<const Served> served_;
  std::string failure_;  // of the last reload; empty when it went well
  bool stopping_ = false;
};

// Figures for `stats`. Plain counters, each on its own.
struct Counters {
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  std::atomic<std::uint64_t> connections{0}, connections_total{0};
  std::atomic<std::uint64_t> requests_total{0}, errors_total{0}, rejected_total{0};
  std::atomic<std::uint64_t> in_flight{0};
  std::atomic<std::uint64_t> localized{0}, ambiguous{0}, not_found{0};
  std::atomic<std::uint64_t> query_us_total{0}, query_us_max{0};
  std::atomic<std::uint64_t> recognized{0}, recognize_not_found{0};
  std::atomic<std::uint64_t> recognize_us_total{0}, recognize_us_max{0};
  std::atomic<std::uint64_t> tracks_open{0}, track_frames{0}, track_frames_seen{0};
  std::atomic<std::uint64_t> track_us_total{0}, track_us_max{0};
  std::atomic<std::uint64_t> reloads_total{0};
};

}  // namespace landmarkdb
