#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bench/load/figures.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::bench {

// Clients that each hold one connection and ask one question after another, taking the clouds in
// turn, the i-th client from the i-th on.
struct ClientsOptions {
  std::string server;  // as client::ConnectOptions::server
  std::string token;
  int clients = 1;
  std::chrono::milliseconds pause{0};  // between an answer and the next question
};

// Asks until `end`; a question asked before it is waited for. One thread a client. Throws what
// connecting throws; what a question brings is counted. A refused client waits 50 ms; one whose
// connection broke makes another.
std::vector<Request> run_clients(const ClientsOptions& options,
                                 std::span<const PointCloud> clouds,
                                 std::chrono::steady_clock::time_point end);

// One client that keeps `in_flight` questions open on one connection until `end`, and waits for
// those open then. A refused question is asked again after 50 ms.
std::vector<Request> run_heavy_client(const ClientsOptions& options,
                                      std::size_t in_flight,
                                      std::span<const PointCloud> clouds,
                                      std::chrono::steady_clock::time_point end);

}  // namespace landmarkdb::bench
