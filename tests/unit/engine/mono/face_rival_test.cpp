#include "engine/mono/face_rival.hpp"

#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/engine/mono/body_view.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

using testing::look;
using testing::plain_box;
using testing::View;

double odds_of(const SearchModel& model, const View& view) {
  std::vector<SeenCorner> corners;
  for (std::size_t i = 0; i < view.points.size(); ++i)
    corners.push_back({view.numbers[i], view.points[i].uv, view.points[i].sigma_px});
  return face_rival(model, testing::bent_camera(), view.pose, corners, {}).value();
}

TEST(FaceRival, SpeaksForABodyOfTheModelsShape) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08);
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_GT(odds_of(model, look(model, model, 0.3, seed)), 0.5) << seed;
}

TEST(FaceRival, SpeaksAgainstABoxOfOtherProportions) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08), other = plain_box(0.10, 0.13, 0.095);
  EXPECT_LT(odds_of(model, look(model, other, 0.0, 1)), -1.0);
}

// A box has two proportions, one with a wedge cut off has more to agree on.
TEST(FaceRival, SaysMoreOfABodyOfMoreFaces) {
  const SearchModel box = plain_box(0.12, 0.10, 0.08);
  const SearchModel cut = prepare_model(testing::box_record());
  EXPECT_GT(odds_of(cut, look(cut, cut, 0.0, 1)), odds_of(box, look(box, box, 0.0, 1)) + 0.5);
}

TEST(FaceRival, SaysNothingWhereThereIsNothingToSee) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08);
  View view = look(model, model, 0.0, 1);
  EXPECT_EQ(face_rival(model, testing::bent_camera(), view.pose, {}, {}), std::nullopt);
  view.points.resize(3);  // fix the pose: faces fit wherever they are
  EXPECT_LT(std::abs(odds_of(model, view)), 0.5);
}

}  // namespace
}  // namespace landmarkdb
