#include "bench/retrieval/object_tally.hpp"

#include <gtest/gtest.h>

namespace landmarkdb::bench {
namespace {

// A carton at the scene's origin, seen by a camera there, and an answer that names
// `T_scene_object`.
struct OneCarton {
  datasets::ObjectModel carton =
      datasets::make_object({.kind = datasets::ObjectKind::kCarton, .seed = 1});
  AskedScene asked = [this] {
    AskedScene scene;
    scene.models = {&carton};
    scene.known = 1;
    scene.scene.frame.T_scene_camera = Eigen::Isometry3d::Identity();
    scene.scene.things.push_back({.model = 0,
                                  .T_scene_object = Eigen::Isometry3d::Identity(),
                                  .pixels = 5000,
                                  .unhidden = 1.0});
    return scene;
  }();

  QueryResult answer(const Eigen::Isometry3d& T_scene_object) const {
    QueryResult result;
    result.status = QueryStatus::kLocalized;
    Hypothesis hypothesis;
    hypothesis.scene = carton.name;
    hypothesis.confidence = 0.9;
    hypothesis.T_scene_sensor = T_scene_object.inverse().matrix();
    result.hypotheses.push_back(hypothesis);
    return result;
  }
};

TEST(JudgeHypothesis, KnowsRightFromRightUpToASymmetry) {
  const OneCarton one;
  const auto judge = [&](const Eigen::Isometry3d& T) {
    return judge_hypothesis(one.answer(T).hypotheses[0], one.asked);
  };
  EXPECT_TRUE(judge(Eigen::Isometry3d::Identity()).right);
  EXPECT_FALSE(judge(one.carton.symmetries[2]).right);
  EXPECT_TRUE(judge(one.carton.symmetries[2]).right_symmetric);
  Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
  off.translation().x() = 0.05;
  EXPECT_FALSE(judge(off).right_symmetric);
}

TEST(ObjectTally, CountsRightWrongAndFalseClaims) {
  OneCarton one;
  ObjectTally tally;
  tally.add(one.answer(one.carton.symmetries[0]), one.asked);
  EXPECT_EQ(tally.shown_right, 1U);
  EXPECT_EQ(tally.claimed, 1U);
  one.asked.known = 0;  // not in the catalogue
  tally.add(one.answer(Eigen::Isometry3d::Identity()), one.asked);
  EXPECT_EQ(tally.none_wrong, 1U);
  EXPECT_EQ(tally.claims, 2U);
  EXPECT_EQ(tally.false_claims, 1U);
}

}  // namespace
}  // namespace landmarkdb::bench
