#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/types/point_cloud.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/memory_budget.hpp"

namespace landmarkdb {

// 20 million points are 240 MB of float32: more than the largest terrestrial scan we know, little
// enough for a request.
inline constexpr std::uint64_t kDefaultMaxPoints = 20'000'000;

// What the clouds of one request may still hold; each decoded cloud takes its points from it, and
// the bytes of its points from `memory`, which get them back when the allowance goes.
struct PointAllowance {
  std::uint64_t points = kDefaultMaxPoints;
  MemoryBudget* memory = nullptr;  // null: bytes are not counted
  std::vector<MemoryBudget::Lease> held{};
};

// A zstd frame may ask for a window of as many bytes to be decompressed: what RFC 8878 wants every
// decoder to support, and what level 19 needs at most. Each thread that computes may hold one.
inline constexpr int kMaxZstdWindowLog = 23;

// The cloud of a message. Counts, lengths and the size after decompression are checked before
// anything is allocated or decompressed. Invalid points come out as NaN. `field` is the cloud's
// place in the request, for messages.
//
// Throws Error{kInvalidArgument} for a cloud that cannot be, Error{kResourceExhausted} for one that
// is larger than the allowance, or needs more memory than the server has left.
PointCloud from_proto(const v1::Cloud& cloud, PointAllowance& allowance, const std::string& field);

// A finite vector; throws Error{kInvalidArgument} naming `field` otherwise.
Eigen::Vector3d from_proto(const v1::Vector3& vector, const std::string& field);
v1::Vector3 to_proto(const Eigen::Vector3d& vector);

}  // namespace landmarkdb
