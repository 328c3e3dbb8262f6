#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace landmarkdb::bench {

// What became of one request.
enum class RequestOutcome {
  kAnswered,  // "not found" is an answer
  kRefused,   // the server had too much to do and said so
  kFailed,    // any other error
};

struct Request {
  RequestOutcome outcome = RequestOutcome::kAnswered;
  double milliseconds = 0.0;  // from before it was sent until its reply was read
};

// The nearest-rank quantile: the smallest value that at least the share `p` (0..1) of all are not
// above. 0 of none.
double quantile(std::vector<double> values, double p);

// What a client, or several, saw. Times are of what was answered; a refusal is quick, and would
// flatter them.
struct LoadFigures {
  std::size_t answered = 0, refused = 0, failed = 0;
  double per_second = 0.0;  // answered
  double p50_ms = 0.0, p95_ms = 0.0, p99_ms = 0.0;
};
LoadFigures load_figures(const std::vector<Request>& requests, double seconds);

// What a heavy client costs the light ones.
struct Fairness {
  LoadFigures alone;         // the light clients without the heavy one
  LoadFigures beside_heavy;  // the same with it
  LoadFigures heavy;

  // How many times longer a light client waits for 95 of 100 answers; 0 where it got none in one of
  // the two.
  double p95_ratio() const;
};

// How far the last of the values is above the first, as a share of the first; 0 of fewer than two.
double growth(const std::vector<double>& values);

nlohmann::json to_json(const LoadFigures& figures);
nlohmann::json to_json(const Fairness& fairness);

}  // namespace landmarkdb::bench
