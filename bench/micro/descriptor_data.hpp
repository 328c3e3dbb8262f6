#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace landmarkdb::bench {

struct DescriptorDataOptions {
  std::size_t stored = 0;
  std::size_t queries = 0;
  std::uint64_t seed = 10'000;
  int threads = 2;
};

// Rows of kShotLength. Stored: SHOT of scans of generated places of all types, at the lengths of a
// lobby, in the order of the places. Queries: SHOT of depth frames taken in some of these places.
struct DescriptorData {
  std::vector<float> stored;
  std::vector<float> queries;
};

// Same options, same rows. 1M takes some minutes, so `cache` names a file that is read where it
// fits the options and written where it does not; empty: none. Throws Error where the file cannot
// be written.
DescriptorData make_descriptor_data(const DescriptorDataOptions& options, const std::string& cache);

}  // namespace landmarkdb::bench
