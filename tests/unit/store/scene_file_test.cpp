#include "store/scene_file.hpp"

#include <algorithm>

#include "store/sha256.hpp"
#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using testing::expect_same_record;
using ::testing::HasSubstr;
using testing::make_record;
using testing::read_file;
using testing::TempFolder;
using testing::write_file;

class SceneFileTest : public ::testing::Test {
 protected:
  SceneFileTest() {
    store_.insert(make_record("lobby", 1, {.points = 50, .keypoints = 4}), {});
    store_.tag("lobby", "floor", "1");
    store_.add_landmark("lobby", {"vent", {0, 0, 0}, {1, 1, 0.1}});
    store_.export_scene("lobby", path_, {});
  }

  TempFolder folder_;
  std::string path_ = folder_.file("lobby.scene");
  Store store_ = Store::create_or_open(":memory:");
};

TEST_F(SceneFileTest, AnExportedSceneComesBackElsewhere) {
  Store other = Store::create_or_open(":memory:");
  const InsertResult result = other.import_scene(path_, {});
  EXPECT_EQ(result.version, 1);
  const SceneSummary scene = other.show("lobby");
  EXPECT_EQ(scene.tags.at("floor"), "1");
  ASSERT_EQ(scene.landmarks.size(), 1U);
  EXPECT_EQ(scene.landmarks[0].max_m, Eigen::Vector3d(1, 1, 0.1));
  // The very same bytes, so the very same answers.
  EXPECT_EQ(scene.versions[0].sha256, store_.show("lobby").versions[0].sha256);
  EXPECT_EQ(other.load("lobby")->descriptors.values, store_.load("lobby")->descriptors.values);
  expect_same_record(*other.load("lobby"), make_record("lobby", 1, {.points = 50, .keypoints = 4}));
  other.export_scene("lobby", folder_.file("again.scene"), {});
  EXPECT_EQ(read_file(folder_.file("again.scene")), read_file(path_));
}

TEST_F(SceneFileTest, ImportMakesANewVersionOfAnExistingNameOrTakesAnother) {
  EXPECT_EQ(store_.import_scene(path_, {}).version, 2);
  EXPECT_EQ(store_.import_scene(path_, {}, "copy").version, 1);
  EXPECT_EQ(store_.load("copy")->name, "copy");
  EXPECT_EQ(error_of([&] { store_.import_scene(path_, {}, "a/b"); }).code,
            ErrorCode::kInvalidArgument);
}

TEST_F(SceneFileTest, ExportNeverWritesOverAFile) {
  const std::string before = read_file(path_);
  EXPECT_EQ(error_of([&] { store_.export_scene("lobby", path_, {}); }).code,
            ErrorCode::kAlreadyExists);
  EXPECT_EQ(read_file(path_), before);
  EXPECT_EQ(error_of([&] { store_.export_scene("office", folder_.file("o"), {}); }).code,
            ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("o")));
}

TEST_F(SceneFileTest, AFileCutOffAnywhereIsRefused) {
  const std::string whole = read_file(path_);
  const std::string cut = folder_.file("cut");
  for (std::size_t size = 0; size < whole.size(); size += size < 2000 ? 7 : 211) {
    write_file(cut, whole.substr(0, size));
    const auto thrown = error_of([&] { store_.import_scene(cut, {}); });
    EXPECT_EQ(thrown.code, ErrorCode::kInvalidArgument) << size;
    EXPECT_THAT(thrown.message, HasSubstr(cut)) << size;
  }
  write_file(cut, whole + "x");
  EXPECT_THAT(error_of([&] { store_.import_scene(cut, {}); }).message,
              HasSubstr("1 bytes follow its end"));
  EXPECT_EQ(store_.show("lobby").versions.size(), 1U);
}

TEST_F(SceneFileTest, EveryFlippedBitIsSeen) {
  const std::string whole = read_file(path_);
  const std::string flipped = folder_.file("flipped");
  Random random(2);
  for (int round = 0; round < 400; ++round) {
    std::string bytes = whole;
    const std::size_t at = random.below(bytes.size());
    bytes[at] = static_cast<char>(bytes[at] ^ (1U << random.below(8)));
    write_file(flipped, bytes);
    const auto thrown = error_of([&] { store_.import_scene(flipped, {}); });
    EXPECT_TRUE(thrown.code == ErrorCode::kInvalidArgument ||
                thrown.code == ErrorCode::kUnimplemented)
        << at << ": " << thrown.message;
  }
}

// Someone who makes a file by hand gets all digests right; the content must hold by itself.
TEST_F(SceneFileTest, AWellSignedLieIsRefused) {
  const auto refused = [this](const auto& change) {
    SceneFile file = read_scene_file(path_, {});
    change(file);
    const std::string path = folder_.file("lie");
    write_scene_file(path, file, {});
    const auto thrown = error_of([&] { store_.import_scene(path, {}); });
    return thrown.code == ErrorCode::kInvalidArgument;
  };
  const auto resign = [](Segment& segment) {
    segment.manifest_json = manifest_to_json(segment.manifest);
    segment.sha256 = sha256_of(segment.manifest_json);
  };
  EXPECT_TRUE(refused([](SceneFile& f) { f.name = "../../etc/passwd"; }));
  EXPECT_TRUE(refused([](SceneFile& f) { f.extras.tags["a\nb"] = ""; }));
  EXPECT_TRUE(refused([](SceneFile& f) { f.extras.landmarks[0].max_m.x() = -5; }));
  EXPECT_TRUE(refused([](SceneFile& f) { f.segment.sha256 = std::string(64, '0'); }));
  EXPECT_TRUE(refused([](SceneFile& f) { f.segment.manifest_json = "{}"; }));
  EXPECT_TRUE(refused([&](SceneFile& f) {  // a count of 10^12
    f.segment.manifest.arrays[0].shape = {1'000'000'000'000, 3};
    f.segment.manifest.arrays[0].bytes = 12'000'000'000'000;
    resign(f.segment);
  }));
  EXPECT_TRUE(refused([&](SceneFile& f) {  // more normals than points
    ArrayInfo& normals = f.segment.manifest.arrays[1];
    normals.shape[0] += 1;
    normals.bytes += 12;
    f.segment.arrays[1].resize(normals.bytes);
    normals.sha256 = sha256_of(f.segment.arrays[1]);
    resign(f.segment);
  }));
  EXPECT_TRUE(refused([&](SceneFile& f) {  // NaN everywhere
    for (std::size_t i = 0; i < f.segment.arrays.size(); ++i) {
      std::fill(f.segment.arrays[i].begin(), f.segment.arrays[i].end(), std::byte{0xff});
      f.segment.manifest.arrays[i].sha256 = sha256_of(f.segment.arrays[i]);
    }
    resign(f.segment);
  }));
}

TEST_F(SceneFileTest, ANewerLayoutIsRefusedAsSuch) {
  std::string bytes = read_file(path_);
  bytes[8] = 2;
  write_file(folder_.file("newer"), bytes);
  EXPECT_EQ(error_of([&] { store_.import_scene(folder_.file("newer"), {}); }).code,
            ErrorCode::kUnimplemented);
}

TEST_F(SceneFileTest, WhatIsNoFileIsRefused) {
  for (const std::string& path :
       {std::string(), folder_.path(), folder_.file("nothing"), std::string("/dev/zero")}) {
    EXPECT_EQ(error_of([&] { store_.import_scene(path, {}); }).code, ErrorCode::kInvalidArgument);
  }
  write_file(folder_.file("text"), "ply\nformat ascii 1.0\n");
  EXPECT_THAT(error_of([&] { store_.import_scene(folder_.file("text"), {}); }).message,
              HasSubstr("no landmarkdb scene file"));
}

TEST_F(SceneFileTest, AStoppedExportLeavesNoFile) {
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_EQ(error_of([&] { store_.export_scene("lobby", folder_.file("b"), context); }).code,
            ErrorCode::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("b")));
}

}  // namespace
}  // namespace landmarkdb
