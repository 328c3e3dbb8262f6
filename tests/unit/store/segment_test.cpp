#include "store/segment.hpp"

#include <cmath>

#include "store/sha256.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using testing::expect_same_record;
using ::testing::HasSubstr;
using testing::make_record;

constexpr const char* kWhat = "scene 'lobby' version 2";

TEST(Segment, ARecordComesBack) {
  const SceneRecord record = make_record("lobby");
  expect_same_record(decode_segment(encode_segment(record), "lobby", kWhat), record);
}

TEST(Segment, ARecordWithoutOptionalPartsComesBack) {
  SceneRecord record = make_record("lobby", 2, {.points = 5, .keypoints = 0});
  record.up.reset();
  record.sources.clear();
  record.prepared.viewpoints.clear();
  record.prepared.viewpoint_index.clear();
  expect_same_record(decode_segment(encode_segment(record), "lobby", kWhat), record);
}

TEST(Segment, WithoutDescriptorsNoRadiusIsNeeded) {
  SceneRecord record = make_record("lobby", 2, {.points = 5, .keypoints = 0});
  record.options.normal_radius_m = 0.0;
  record.options.shot_radius_m = 0.0;
  EXPECT_NO_THROW(encode_segment(record));
}

TEST(Segment, TheSameRecordGivesTheSameBytes) {
  const Segment first = encode_segment(make_record("lobby", 7));
  const Segment second = encode_segment(make_record("another name", 7));
  EXPECT_EQ(first.manifest_json, second.manifest_json);
  EXPECT_EQ(first.sha256, second.sha256);
  EXPECT_EQ(first.arrays, second.arrays);
  EXPECT_NE(first.sha256, encode_segment(make_record("lobby", 8)).sha256);
}

TEST(Segment, DecodingIsTheSameEachTime) {
  const Segment segment = encode_segment(make_record("lobby"));
  const SceneRecord first = decode_segment(segment, "lobby", kWhat);
  const SceneRecord second = decode_segment(segment, "lobby", kWhat);
  EXPECT_EQ(first.descriptors.values, second.descriptors.values);
  EXPECT_EQ(first.descriptors.frames, second.descriptors.frames);
}

TEST(Segment, RecordsThatDoNotFitTogetherAreRefused) {
  const auto refused = [](const auto& change) {
    SceneRecord record = make_record("lobby");
    change(record);
    const auto thrown = error_of([&] { encode_segment(record); });
    return thrown.code == ErrorCode::kInvalidArgument &&
           thrown.message.starts_with("scene 'lobby'");
  };
  const float nan = std::nanf("");
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.normals.pop_back(); }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.viewpoint_index.pop_back(); }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.viewpoint_index[3] = 2; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.descriptors.values.pop_back(); }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.descriptors.frames.pop_back(); }));
  EXPECT_TRUE(refused([&](SceneRecord& r) { r.prepared.points[0].x() = nan; }));
  EXPECT_TRUE(refused([&](SceneRecord& r) { r.descriptors.values[9] = nan; }));
  EXPECT_TRUE(refused([&](SceneRecord& r) { r.descriptors.frames[1](0, 0) = nan; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.origin.y() = HUGE_VAL; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.options.voxel_m = -1.0; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.options.voxel_m = 0.0; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.options.normal_radius_m = 0.0; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.options.shot_radius_m = 0.0; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.resolution_m = 0.0; }));
  EXPECT_TRUE(refused([&](SceneRecord& r) { r.prepared.resolution_m = nan; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.points[1].z() = 3e38F; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.points[1].z() = -1e7F; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.viewpoints[0].x() = 3e38F; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.descriptors.keypoints[0].y() = 1e30F; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.prepared.origin.x() = 1e300; }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.up = Eigen::Vector3d::Zero(); }));
  EXPECT_TRUE(refused([](SceneRecord& r) { r.descriptors.values[0] = 1e6F; }));
}

TEST(Segment, AManifestThatIsTooLongIsRefused) {
  SceneRecord record = make_record("lobby");
  record.sources.emplace_back(2'000'000, 'x');
  EXPECT_EQ(error_of([&] { encode_segment(record); }).code, ErrorCode::kInvalidArgument);
}

TEST(Segment, ACutOffArrayIsNamedWithItsLengths) {
  Segment segment = encode_segment(make_record("lobby"));
  segment.arrays.back().resize(1000);
  const auto thrown = error_of([&] { decode_segment(segment, "lobby", kWhat); });
  EXPECT_EQ(thrown.code, ErrorCode::kDataLoss);
  EXPECT_EQ(thrown.message,
            "scene 'lobby' version 2: array 'descriptors' has 1000 bytes, want 14080");
}

TEST(Segment, AMissingArrayOrWrongShapeIsNamed) {
  Segment segment = encode_segment(make_record("lobby"));
  segment.manifest.arrays[0].name = "dots";
  EXPECT_THAT(error_of([&] { decode_segment(segment, "lobby", kWhat); }).message,
              HasSubstr("array 'points' is missing"));
  segment = encode_segment(make_record("lobby"));
  segment.manifest.arrays[4].shape = {60, 1};
  EXPECT_THAT(error_of([&] { decode_segment(segment, "lobby", kWhat); }).message,
              HasSubstr("array 'keypoints' does not have the type and shape"));
}

TEST(Segment, ArraysItDoesNotKnowAreLeftAlone) {
  Segment segment = encode_segment(make_record("lobby"));
  segment.manifest.arrays.push_back({"index", DType::kUint16, {1}, 2, ""});
  segment.arrays.emplace_back(2);
  EXPECT_NO_THROW(decode_segment(segment, "lobby", kWhat));
}

TEST(VerifyArray, SeesAFlippedBit) {
  const std::vector<std::byte> bytes(100, std::byte{7});
  const ArrayInfo info{"points", DType::kUint16, {50}, 100, sha256_of(bytes)};
  EXPECT_NO_THROW(verify_array(info, bytes, kWhat));
  std::vector<std::byte> flipped = bytes;
  flipped[50] ^= std::byte{1};
  const auto thrown = error_of([&] { verify_array(info, flipped, kWhat); });
  EXPECT_EQ(thrown.code, ErrorCode::kDataLoss);
  EXPECT_THAT(thrown.message, HasSubstr("scene 'lobby' version 2: array 'points' is damaged"));
}

}  // namespace
}  // namespace landmarkdb
