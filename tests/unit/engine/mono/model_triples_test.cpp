#include "engine/mono/model_triples.hpp"

#include <algorithm>
#include <set>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/mono/visibility.hpp"
#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using testing::box_json;
using testing::read_text;
using ::testing::SizeIs;

TEST(ModelTriples, ABoxHasItsJunctionsAndNothingTwice) {
  const MonoModel model = read_text(box_json(), "box.json").model;
  const std::vector<ModelTriple> triples = make_triples(model);
  // Three pairs of edges in each of eight corners; they are the face triples too.
  ASSERT_THAT(triples, SizeIs(24));
  std::set<std::set<std::uint32_t>> seen;
  for (const ModelTriple& t : triples) {
    EXPECT_LT(t.points[1], t.points[2]);
    EXPECT_EQ(t.links, 2);
    EXPECT_GE(t.face, 0);
    EXPECT_TRUE(seen.insert({t.points.begin(), t.points.end()}).second);
    EXPECT_NEAR(t.min_sin, std::min({t.lengths_m[0], t.lengths_m[1]}) / t.lengths_m[2], 1e-12);
  }
  EXPECT_TRUE(std::is_sorted(triples.begin(), triples.end(), [](const auto& a, const auto& b) {
    return a.points < b.points;
  }));
}

TEST(ModelTriples, FacesWithoutListedEdgesGiveFaceTriples) {
  const MonoModel model = read_text(box_json(R"(, "edges": [[0,1]])"), "box.json").model;
  const std::vector<ModelTriple> triples = make_triples(model);
  EXPECT_THAT(triples, SizeIs(6 * 4));
  for (const ModelTriple& t : triples) EXPECT_LE(t.links, 1);
}

TEST(ModelTriples, TheBasisInvertsTheTriangle) {
  Random random(7);
  for (int round = 0; round < 1000; ++round) {
    MonoModel model;
    for (int i = 0; i < 3; ++i) {
      model.points.push_back(
          {FeatureType::kVertex,
           {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}});
    }
    ModelTriple t;
    t.points = {2, 0, 1};
    if (!make_triple(model, t) || t.min_sin < 0.05) continue;
    Eigen::Matrix3d axes;
    axes << t.u, t.v, t.n;
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
    const Eigen::Vector3d e1 = model.points[0].xyz - model.points[2].xyz;
    const Eigen::Vector3d e2 = model.points[1].xyz - model.points[2].xyz;
    Eigen::Matrix2d E, inverse;
    E << e1.dot(t.u), e2.dot(t.u), e1.dot(t.v), e2.dot(t.v);
    inverse << t.inverse[0], t.inverse[1], 0.0, t.inverse[2];
    EXPECT_TRUE((E * inverse).isApprox(Eigen::Matrix2d::Identity(), 1e-9));
    EXPECT_NEAR(e1.dot(t.n), 0.0, 1e-12);
    EXPECT_NEAR(e2.dot(t.n), 0.0, 1e-12);
  }
}

TEST(ModelTriples, TheSignatureHoldsTheTypesInOrder) {
  MonoModel model;
  model.points = {{FeatureType::kInflexion, {0, 0, 0}},
                  {FeatureType::kConicCentre, {1, 0, 0}},
                  {FeatureType::kCentroid, {0, 1, 0}}};
  ModelTriple t;
  t.points = {0, 1, 2};
  ASSERT_TRUE(make_triple(model, t));
  EXPECT_EQ(t.type_signature, 3U | 1U << 2U | 2U << 4U);
}

TEST(ModelTriples, CollinearAndCoincidentOnesAreNotMade) {
  const MonoModel model = read_text(
                              R"({"points": [[0,0,0],[0.1,0,0],[0.2,0.00005,0],[0,0.1,0]],
          "edges": [[0,1],[1,2],[1,3]]})",
                              "a.json")
                              .model;
  const std::vector<ModelTriple> triples = make_triples(model);
  ASSERT_THAT(triples, SizeIs(2));
  for (const ModelTriple& t : triples) EXPECT_EQ(t.points[2], 3U);
  MonoModel twins;
  twins.points = {{FeatureType::kVertex, {0, 0, 0}},
                  {FeatureType::kVertex, {0, 0, 0}},
                  {FeatureType::kVertex, {0, 0, 0}}};
  ModelTriple t;
  t.points = {0, 1, 2};
  EXPECT_FALSE(make_triple(twins, t));
}

TEST(ModelTriples, ViewsAreThoseThatSeeAllThree) {
  const MonoModel model = read_text(box_json(), "box.json").model;
  const ModelVisibility visibility(model);
  for (const ModelTriple& t : make_triples(model)) {
    EXPECT_GT(t.views.count(), 100U);
    for (const std::size_t view : {0U, 77U, 140U, 255U}) {
      const std::vector<bool> seen = visibility.points_along(model_views()[view]);
      const bool all = seen[t.points[0]] && seen[t.points[1]] && seen[t.points[2]];
      EXPECT_EQ(t.views.test(view), all);
    }
  }
}

TEST(ModelTriples, AThreePointModelHasOne) {
  const MonoModel model =
      read_text(R"({"points": [[0,0,0],[0.1,0,0],[0,0.1,0]], "edges": [[0,1],[0,2]]})", "a.json")
          .model;
  EXPECT_THAT(make_triples(model), SizeIs(1));
  EXPECT_EQ(make_triples(model)[0].views.count(), kModelViews);
}

}  // namespace
}  // namespace landmarkdb
