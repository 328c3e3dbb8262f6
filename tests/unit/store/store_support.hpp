#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/types/scene_record.hpp"
#include "tests/support/temp_folder.hpp"

namespace landmarkdb::testing {

struct RecordSize {
  std::size_t points = 200;
  std::size_t keypoints = 20;
};

// A record with every field filled; the same name and seed give the same record.
SceneRecord make_record(const std::string& name, std::uint64_t seed = 1, RecordSize size = {});

// All fields are the same; descriptors to the rounding of halves, frames to that of quaternions.
void expect_same_record(const SceneRecord& seen, const SceneRecord& wanted);

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& bytes);

// What `job` threw: code and message. Fails the test when it throws something else or nothing.
struct Thrown {
  ErrorCode code = ErrorCode::kUnknown;
  std::string message;
};

template <typename Job>
Thrown error_of(const Job& job) {
  try {
    job();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

}  // namespace landmarkdb::testing
