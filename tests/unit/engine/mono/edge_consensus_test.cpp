#include "engine/mono/edge_consensus.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "engine/mono/visibility.hpp"
#include "tests/unit/engine/mono/body_view.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

using testing::plain_box;

// An image with the visible edges of a body in it, a point each pixel.
ImageFeatures image_of(const SearchModel& body, const RigidPose& pose) {
  const Camera camera = testing::bent_camera();
  ImageFeatures features;
  features.width = camera.width;
  features.height = camera.height;
  for (const EdgeSample& sample : visible_edges(body, camera, pose, 1.0, 100'000))
    features.edges.push_back({sample.uv.cast<float>(), sample.normal.cast<float>()});
  return features;
}

RigidPose somewhere() {
  return {rotation_from_vector({0.7, -0.5, 0.3}), Eigen::Vector3d(0.02, -0.03, 0.7)};
}

EdgeEvidence judge(const SearchModel& model, const RigidPose& pose, const ImageFeatures& image) {
  EdgeEvidence evidence;
  judge_lines(model, testing::bent_camera(), pose, EdgeGrid(image), 1.0, evidence);
  return evidence;
}

TEST(EdgeConsensus, TheEdgesOfABoxLieOnItsOwn) {
  const SearchModel box = plain_box(0.10, 0.13, 0.08);
  const EdgeEvidence seen = judge(box, somewhere(), image_of(box, somewhere()));
  EXPECT_GT(seen.supported, 0.95);
  EXPECT_EQ(seen.lined, 9.0);
  EXPECT_LT(seen.bend, 0.05);
}

TEST(EdgeConsensus, CornersMayBeOffAndThatIsTold) {
  const SearchModel box = plain_box(0.10, 0.13, 0.08), other = plain_box(0.10, 0.13, 0.083);
  const EdgeEvidence seen = judge(box, somewhere(), image_of(other, somewhere()));
  EXPECT_GT(seen.supported, 0.9);
  EXPECT_GT(seen.bend, 0.1);
}

TEST(EdgeConsensus, AnImageEdgeWithTheBrightSideNowLeftNowRightIsNone) {
  const SearchModel box = plain_box(0.10, 0.13, 0.08);
  ImageFeatures image = image_of(box, somewhere());
  for (std::size_t i = 0; i < image.edges.size(); ++i) {
    if (i / 20 % 2 == 0) image.edges[i].normal = -image.edges[i].normal;
  }
  EXPECT_LT(judge(box, somewhere(), image).lined, 3.0);
}

TEST(EdgeConsensus, NothingIsSupportedWhereThereAreNoEdges) {
  const SearchModel box = plain_box(0.10, 0.13, 0.08);
  ImageFeatures image = image_of(box, somewhere());
  for (EdgePoint& edge : image.edges) edge.uv *= 0.01F;  // all in a corner
  const EdgeEvidence seen = judge(box, somewhere(), image);
  EXPECT_EQ(seen.supported, 0.0);
  EXPECT_EQ(seen.lined, 0.0);
}

}  // namespace
}  // namespace landmarkdb
