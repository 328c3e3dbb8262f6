#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/types/query.hpp"

namespace landmarkdb::client {

// One line a pair: scene, its point in the sensor frame and in the scene frame (metres), the
// distance of the descriptors, and the filter that dropped it (empty: an inlier). With a header
// line; RFC 4180 quoting.
std::string correspondences_csv(const std::vector<CorrespondenceRecord>& pairs);

// Writes that to a file. Throws Error{kResourceExhausted} when it cannot be written.
void write_correspondences(const std::filesystem::path& path,
                           const std::vector<CorrespondenceRecord>& pairs);

}  // namespace landmarkdb::client
