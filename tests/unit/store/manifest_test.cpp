#include "store/manifest.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using ::testing::HasSubstr;

Manifest make_manifest() {
  Manifest m;
  m.kind = EntryKind::kObject;
  m.options = {0.1, 0.2, 0.3, 0.4, KeypointMethod::kNarf};
  m.origin_m = {1.0 / 3.0, -4'512'345.678'901'2, 1e-12};
  m.resolution_m = 0.1;
  m.counts = {5, 1, 1, 0, 3};
  m.up = Eigen::Vector3d(0, 0, 1);
  m.sources = {"a \"quoted\" name.pcd", "b\n.ply"};
  m.warnings = {"units_suspect"};
  m.arrays = {{"points", DType::kFloat32, {3, 3}, 36, std::string(64, 'a')},
              {"viewpoint_index", DType::kUint16, {0}, 0, std::string(64, 'b')}};
  return m;
}

TEST(Manifest, ComesBackWithEveryField) {
  const Manifest want = make_manifest();
  const Manifest seen = manifest_from_json(manifest_to_json(want), "scene");
  EXPECT_EQ(seen.kind, want.kind);
  EXPECT_EQ(seen.options, want.options);
  EXPECT_EQ(seen.origin_m, want.origin_m);
  EXPECT_EQ(seen.resolution_m, want.resolution_m);
  EXPECT_EQ(seen.counts.used, want.counts.used);
  EXPECT_EQ(seen.up, want.up);
  EXPECT_EQ(seen.sources, want.sources);
  EXPECT_EQ(seen.warnings, want.warnings);
  ASSERT_EQ(seen.arrays.size(), 2U);
  EXPECT_EQ(seen.arrays[0].shape, want.arrays[0].shape);
  EXPECT_EQ(seen.arrays[1].dtype, DType::kUint16);
  EXPECT_EQ(manifest_to_json(seen), manifest_to_json(want));
}

TEST(Manifest, FileNamesThatAreNotUtf8AreKeptReadable) {
  Manifest m = make_manifest();
  m.sources = {"scan\xff.pcd"};
  const Manifest seen = manifest_from_json(manifest_to_json(m), "scene");
  EXPECT_EQ(seen.sources.front(), "scan\xef\xbf\xbd.pcd");
}

TEST(Manifest, AMissingOrWrongFieldIsNamed) {
  const auto json = nlohmann::json::parse(manifest_to_json(make_manifest()));
  for (const auto& [key, value] : json.items()) {
    auto without = json;
    without.erase(key);
    auto thrown = error_of([&] { manifest_from_json(without.dump(), "scene 'x' version 1"); });
    EXPECT_EQ(thrown.code, ErrorCode::kDataLoss);
    EXPECT_THAT(thrown.message, HasSubstr("scene 'x' version 1"));
    EXPECT_THAT(thrown.message, HasSubstr("'" + key + "'"));
    auto wrong = json;
    wrong[key] = nlohmann::json::object({{"what", "is this"}});
    EXPECT_EQ(error_of([&] { manifest_from_json(wrong.dump(), "scene"); }).code,
              ErrorCode::kDataLoss)
        << key;
  }
}

TEST(Manifest, LyingArraysAreRefused) {
  const auto json = nlohmann::json::parse(manifest_to_json(make_manifest()));
  const auto refuses = [&json](const char* key, const nlohmann::json& value) {
    auto changed = json;
    changed["arrays"][0][key] = value;
    return error_of([&] { manifest_from_json(changed.dump(), "scene"); }).code ==
           ErrorCode::kDataLoss;
  };
  EXPECT_TRUE(refuses("bytes", 35));
  EXPECT_TRUE(refuses("bytes", -36));
  EXPECT_TRUE(refuses("shape", {1'000'000'000'000, 3}));
  EXPECT_TRUE(refuses("shape", {std::uint64_t{1} << 62U, std::uint64_t{1} << 62U}));
  EXPECT_TRUE(refuses("shape", nlohmann::json::array()));
  EXPECT_TRUE(refuses("shape", {3, 1, 1, 1, 3}));
  EXPECT_TRUE(refuses("shape", {3.5, 3}));
  EXPECT_TRUE(refuses("dtype", "f80"));
  EXPECT_TRUE(refuses("name", "viewpoint_index"));  // twice
}

TEST(Manifest, AnotherFormatIsRefusedAsSuch) {
  auto json = nlohmann::json::parse(manifest_to_json(make_manifest()));
  json["format"] = 2;
  const auto thrown = error_of([&] { manifest_from_json(json.dump(), "scene"); });
  EXPECT_EQ(thrown.code, ErrorCode::kUnimplemented);
  EXPECT_THAT(thrown.message, HasSubstr("format 2"));
}

TEST(Manifest, TextThatIsNoJsonIsDamage) {
  for (const std::string text : {"", "{", "null", "[1,2]", "\xff\xfe", "{\"format\":1"}) {
    EXPECT_EQ(error_of([&] { manifest_from_json(text, "scene"); }).code, ErrorCode::kDataLoss);
  }
  EXPECT_EQ(error_of([] { manifest_from_json(std::string(2'000'000, '['), "scene"); }).code,
            ErrorCode::kDataLoss);
  EXPECT_EQ(error_of([] { manifest_from_json(std::string(1'000'000, '['), "scene"); }).code,
            ErrorCode::kDataLoss);
}

TEST(ArrayBytes, NeverOverflows) {
  EXPECT_EQ(array_bytes(DType::kFloat16, {10, 352}), 7040U);
  EXPECT_EQ(array_bytes(DType::kFloat32, {0, 3}), 0U);
  EXPECT_EQ(array_bytes(DType::kFloat32, {~std::uint64_t{0}, 2}), std::nullopt);
}

TEST(Texts, DamagedListsAreEmpty) {
  EXPECT_EQ(texts_from_json(texts_to_json({"a", "b"})), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(texts_from_json("{").empty());
  EXPECT_TRUE(texts_from_json("{\"a\": 1}").empty());
}

}  // namespace
}  // namespace landmarkdb
