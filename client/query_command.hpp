#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/program.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::client {

// `query` as it is typed.
struct QueryArguments {
  std::vector<std::string> clouds;
  std::vector<std::string> poses;
  std::string camera;
  std::string units = "m";
  std::vector<std::string> viewpoints;
  std::string profile = "robust";
  std::vector<std::string> scenes;
  std::uint32_t top = 3;
  double min_confidence = 0.5;
  std::string up;
  std::string prior;
  std::string prior_radius;
  std::string keypoints;
  std::string measure = "l2";
  double ratio = 0.7;
  std::string filters;
  std::string search = "exact";
  std::string solver = "similarity";
  bool scale = false;
  std::uint64_t seed = 1;
  std::string correspondences;
  std::string report;
  bool explain = false;
};

// The engine's options. Throws cli::UsageError and, for the prior's file, Error.
QueryOptions query_options(const QueryArguments& arguments);

// The clouds with their poses, read. Throws cli::UsageError and, for a file, Error.
std::vector<QueryCloud> load_query(const QueryArguments& arguments);

// Asks and prints. Returns the exit status: 0 localized, 3 not found, 4 ambiguous. Throws Error.
int run_query(const QueryArguments& arguments, const Program& program);

}  // namespace landmarkdb::client
