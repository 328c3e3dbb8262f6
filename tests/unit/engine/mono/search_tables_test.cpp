#include "engine/mono/search_tables.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/mono/mirror_rival.hpp"
#include "engine/mono/quad_index.hpp"
#include "engine/mono/search_model.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

// 20 x 20 mm apart, all of one type, without edges: its quads are free, and it has lookalikes.
MonoModel dot_grid() {
  MonoModel model;
  model.name = "dots";
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      model.points.push_back({FeatureType::kConicCentre, {0.02 * i, 0.02 * j, 0.0}});
    }
  }
  model.symmetries = {Eigen::Matrix4d::Identity()};
  model.diameter_m = 0.06 * std::sqrt(2.0);
  return model;
}

std::vector<MonoModel> models() {
  std::vector<MonoModel> result{dot_grid(), MonoModel{}};
  result.back().points.push_back({FeatureType::kVertex, {0, 0, 0}});  // too few for any quad
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    result.push_back(testing::make_mono_model({.seed = seed})->model);
    result.push_back(testing::make_mono_model({.seed = seed, .share_of_edges = 0.0})->model);
  }
  return result;
}

void expect_same(const SearchTables& a, const SearchTables& b) {
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.mirror_seen, b.mirror_seen);
  EXPECT_EQ(a.outline_seen, b.outline_seen);
  ASSERT_EQ(a.quads.size(), b.quads.size());
  for (std::size_t i = 0; i < a.quads.size(); ++i) {
    EXPECT_EQ(a.quads[i].ids, b.quads[i].ids);
    EXPECT_EQ(a.quads[i].views, b.quads[i].views);
  }
  ASSERT_EQ(a.lookalikes.size(), b.lookalikes.size());
  for (std::size_t i = 0; i < a.lookalikes.size(); ++i) {
    EXPECT_EQ(a.lookalikes[i].matrix(), b.lookalikes[i].matrix());
  }
}

TEST(SearchTables, ComeBackFromTheirBytes) {
  for (const MonoModel& model : models()) {
    const auto read = read_model_index(make_model_index(model), model);
    ASSERT_TRUE(read);
    expect_same(*read, make_search_tables(model));
  }
  EXPECT_FALSE(make_search_tables(dot_grid()).lookalikes.empty());
}

TEST(SearchTables, AreNotReadFromBytesOfAnotherMaking) {
  const MonoModel model = dot_grid();
  const ModelIndexBlob good = make_model_index(model);
  ModelIndexBlob index = good;
  ++index.version;
  EXPECT_FALSE(read_model_index(index, model));
  index = good;
  index.params += " ";
  EXPECT_FALSE(read_model_index(index, model));
  EXPECT_FALSE(read_model_index(good, testing::make_mono_model({})->model));
}

// Whatever the bytes are, what is read from them fits the model: a search may rely on it.
TEST(SearchTables, NeverComeWrongFromDamagedBytes) {
  const MonoModel model = dot_grid();
  const ModelIndexBlob good = make_model_index(model);
  for (std::size_t length :
       {std::size_t{0}, std::size_t{15}, std::size_t{16}, good.quads.size() - 1}) {
    ModelIndexBlob index = good;
    index.quads.resize(length);
    EXPECT_FALSE(read_model_index(index, model)) << length;
  }
  for (std::size_t at = 0; at < 16; ++at) {
    ModelIndexBlob index = good;
    index.quads[at] = std::byte{0xff};
    EXPECT_FALSE(read_model_index(index, model)) << "count at byte " << at;
  }
  Random random(1);
  std::size_t refused = 0;
  for (int trial = 0; trial < 500; ++trial) {
    ModelIndexBlob index = good;
    for (int k = 0; k < 4; ++k) {
      index.quads[16 + random.below(index.quads.size() - 16)] =
          static_cast<std::byte>(random.next());
    }
    const auto read = read_model_index(index, model);
    if (!read) {
      ++refused;
      continue;
    }
    for (const ChosenQuad& quad : read->quads) {
      for (const std::uint16_t id : quad.ids) ASSERT_LT(id, model.points.size());
    }
    MonoModelRecord record{model};
    record.index = index;
    const std::vector<SearchModel> search{
        prepare_model(std::make_shared<const MonoModelRecord>(record))};
    EXPECT_FALSE(QuadIndex(search).quads().empty());
  }
  EXPECT_GT(refused, 100U);
}

TEST(SearchTables, LeadToTheSameSearchModelStoredOrNot) {
  for (const MonoModel& model : models()) {
    const MonoModelRecord derived = derive_record(model);
    ASSERT_TRUE(derived.index);
    const auto stored = std::make_shared<const MonoModelRecord>(derived);
    const auto bare = std::make_shared<const MonoModelRecord>(MonoModelRecord{model});
    const SearchModel a = prepare_model(stored), b = prepare_model(bare);
    EXPECT_EQ(a.seen, b.seen);
    EXPECT_EQ(prepare_mirror(*stored, tables_of(*stored)).seen,
              prepare_mirror(*bare, tables_of(*bare)).seen);
    const std::vector<ModelQuad> qa = quads_of(a, 0, a.quads), qb = quads_of(b, 0, b.quads);
    ASSERT_EQ(qa.size(), qb.size());
    EXPECT_TRUE(std::equal(qa.begin(), qa.end(), qb.begin(), [](const auto& x, const auto& y) {
      return x.view == y.view && x.ids == y.ids && x.code == y.code && x.links == y.links;
    }));
  }
}

TEST(SearchTables, CanLeaveOutTheQuadsAndReadThemLater) {
  for (const MonoModel& model : models()) {
    const auto stored = std::make_shared<const MonoModelRecord>(derive_record(model));
    for (const auto& record :
         {stored, std::make_shared<const MonoModelRecord>(MonoModelRecord{model})}) {
      const SearchTables all = tables_of(*record);
      const SearchTables some = tables_of(*record, {}, QuadUse::kLeftOut);
      EXPECT_TRUE(some.quads.empty());
      EXPECT_EQ(some.seen, all.seen);
      EXPECT_EQ(some.lookalikes.size(), all.lookalikes.size());
      const std::vector<ChosenQuad> later = read_quads(*record);
      ASSERT_EQ(later.size(), all.quads.size());
      for (std::size_t i = 0; i < later.size(); ++i) {
        EXPECT_EQ(later[i].ids, all.quads[i].ids);
        EXPECT_EQ(later[i].views, all.quads[i].views);
      }
    }
    ModelIndexBlob cut = *stored->index;
    for (std::size_t length = 16; length < cut.quads.size(); length = length * 3 / 2) {
      cut.quads.resize(length);
      EXPECT_FALSE(read_model_index(cut, model, QuadUse::kLeftOut)) << length;
      cut = *stored->index;
    }
  }
}

// What is chosen for a view is seen in it, and no view has more than its share.
TEST(ChooseQuads, KeepsAShareOfEachView) {
  for (const bool linked : {true, false}) {
    const MonoModel model =
        testing::make_mono_model({.seed = 5, .share_of_edges = linked ? 1.0 : 0.0})->model;
    const SearchTables tables = make_search_tables(model);
    std::vector<std::size_t> of_view(kModelViews, 0);
    for (const ChosenQuad& quad : tables.quads) {
      EXPECT_TRUE(std::is_sorted(quad.ids.begin(), quad.ids.end()));
      for (std::size_t view = 0; view < kModelViews; ++view) of_view[view] += quad.views[view];
      for (const std::uint16_t id : quad.ids) EXPECT_TRUE((quad.views & ~tables.seen[id]).none());
    }
    const auto [least, most] = std::minmax_element(of_view.begin(), of_view.end());
    EXPECT_LE(*most, linked ? 150U : 60U);
    EXPECT_GT(*least, 0U);
  }
}

TEST(NearestView, IsTheNearestOfAll) {
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    double best = -2.0;
    for (const Eigen::Vector3d& view : model_views()) best = std::max(best, view.dot(direction));
    // A look-up by place: to a degree or two.
    EXPECT_GT(model_views()[nearest_view(direction)].dot(direction), best - 0.01)
        << direction.transpose();
  }
}

}  // namespace
}  // namespace landmarkdb
