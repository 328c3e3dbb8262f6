#pragma once

#include <span>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/mono/read_model.hpp"

namespace landmarkdb::testing {

inline ReadModelResult read_text(const std::string& text,
                                 std::string_view name,
                                 const ReadModelOptions& options = {}) {
  return parse_model(std::as_bytes(std::span(text)), name, options);
}

// What reading it throws; fails the test when it throws nothing.
inline std::string refusal_of(const std::string& text, std::string_view name) {
  try {
    read_text(text, name);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  ADD_FAILURE() << "it was read";
  return {};
}

// A box of 120 x 80 x 60 mm in metres, its faces counter-clockwise from outside.
inline constexpr std::string_view kBoxPoints =
    R"("points": [[0,0,0],[0.12,0,0],[0.12,0.08,0],[0,0.08,0],
       [0,0,0.06],[0.12,0,0.06],[0.12,0.08,0.06],[0,0.08,0.06]])";
inline constexpr std::string_view kBoxFaces =
    R"("faces": [[0,3,2,1],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]])";

inline std::string box_json(const std::string& more = {}) {
  return "{" + std::string(kBoxPoints) + ", " + std::string(kBoxFaces) + more + "}";
}

}  // namespace landmarkdb::testing
