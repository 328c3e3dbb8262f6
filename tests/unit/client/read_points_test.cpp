#include "client/read_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(ReadPoints, TakesTypesDirectionsAndLinks) {
  RecognizeInput input;
  parse_points(R"({"points": [{"uv": [1, 2.5]}, {"type": "conic_centre", "uv": [3, 4],
                   "directions": [0.5, -1]}], "links": [[0, 1]], "other": 1})",
               "p.json",
               input);
  ASSERT_THAT(input.points, SizeIs(2));
  EXPECT_EQ(input.points[0].type, FeatureType::kVertex);
  EXPECT_EQ(input.points[0].uv, Eigen::Vector2d(1, 2.5));
  EXPECT_EQ(input.points[1].type, FeatureType::kConicCentre);
  EXPECT_THAT(input.points[1].directions_rad, ElementsAre(0.5, -1.0));
  EXPECT_THAT(input.links, ElementsAre(ElementsAre(0, 1)));
}

TEST(ReadPoints, NamesTheFileAndThePointAtFault) {
  for (const auto& [text, want] : {
           std::pair<std::string, std::string>{"{", "not valid JSON"},
           {"[]", "no list \"points\""},
           {R"({"points": [3]})", "point 0 is a number"},
           {R"({"points": [{"uv": [1, 2]}, {"uv": [1]}]})", "point 1 has no \"uv\""},
           {R"({"points": [{"uv": [1, "x"]}]})", "want finite numbers"},
           {R"({"points": [{"uv": [1, 2], "type": "edge"}]})", "type"},
           {R"({"points": [{"uv": [1, 2], "directions": 1}]})", "no list"},
           {R"({"points": [{"uv": [1, 2]}], "links": [[0]]})", "no pair"},
           {R"({"points": [{"uv": [1, 2]}], "links": [[0, 1]]})", "names point"},
       }) {
    RecognizeInput input;
    try {
      parse_points(text, "p.json", input);
      ADD_FAILURE() << "was read: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_THAT(error.what(), HasSubstr(want));
      EXPECT_THAT(error.what(), HasSubstr("p.json"));
    }
  }
}

}  // namespace
}  // namespace landmarkdb::client
