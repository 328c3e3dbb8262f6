#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

constexpr int kPoints = 20'000;

class ReadCloudInBlocks : public ::testing::Test {
 protected:
  ~ReadCloudInBlocks() override { std::filesystem::remove(path_); }

  void write(const testing::NamedFile& file) {
    path_ = std::filesystem::path(::testing::TempDir()) / ("blocks_" + file.name);
    std::ofstream(path_, std::ios::binary) << file.bytes;
  }

  std::vector<PointCloud> read(std::size_t block_points, const ReadOptions& options) {
    std::vector<PointCloud> blocks;
    read_cloud_in_blocks(path_, options, {}, {block_points, [&](PointCloud block) {
                                                blocks.push_back(std::move(block));
                                              }});
    return blocks;
  }

  std::filesystem::path path_;
};

std::vector<testing::NamedFile> large_files() {
  std::string crlf = testing::xyz_text(kPoints);
  for (std::size_t at = 0; (at = crlf.find('\n', at)) != std::string::npos; at += 2) {
    crlf.replace(at, 1, "\r\n");
  }
  return {{"a.ply", testing::ply_ascii(kPoints)},
          {"b.ply", testing::ply_binary(kPoints, false)},
          {"c.ply", testing::ply_binary(kPoints, true)},
          {"a.pcd", testing::pcd_ascii(kPoints)},
          {"b.pcd", testing::pcd_binary(kPoints)},
          {"c.pcd", testing::pcd_compressed(kPoints)},
          {"a.xyz", testing::xyz_text(kPoints)},
          {"b.xyz", crlf},
          {"a.pts", testing::pts_text(kPoints)}};
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

TEST_F(ReadCloudInBlocks, GivesWhatTheWholeCloudHasWhereverTheWindowEnds) {
  for (const testing::NamedFile& file : large_files()) {
    write(file);
    const PointCloud whole = testing::parse(file.bytes, file.name);
    ASSERT_EQ(whole.size(), static_cast<std::size_t>(kPoints));
    for (const std::size_t window : {1024U, 1500U, 100'000U}) {
      const std::vector<PointCloud> blocks = read(5000, {.window_bytes = window});
      ASSERT_EQ(blocks.size(), 4U) << file.name;
      PointCloud joined;
      for (const PointCloud& block : blocks) {
        EXPECT_EQ(block.size(), 5000U);
        EXPECT_EQ(block.origin, whole.origin);
        EXPECT_EQ(block.viewpoints, whole.viewpoints);
        EXPECT_EQ(block.width, 0U);
        append(joined.points, block.points);
        append(joined.normals, block.normals);
        append(joined.colours, block.colours);
      }
      EXPECT_EQ(joined.points, whole.points) << file.name << ", window " << window;
      EXPECT_EQ(joined.normals, whole.normals) << file.name;
      EXPECT_EQ(joined.colours, whole.colours) << file.name;
    }
  }
}

TEST_F(ReadCloudInBlocks, GivesAWholeCloudAsOneBlockAndReadCloudReadsTheSame) {
  for (const testing::NamedFile& file : testing::one_of_each()) {
    write(file);
    const PointCloud whole = testing::parse(file.bytes, file.name);
    const ReadOptions options{.window_bytes = 700};
    const std::vector<PointCloud> blocks = read(1'000'000, options);
    ASSERT_EQ(blocks.size(), 1U) << file.name;
    EXPECT_EQ(blocks[0].points, whole.points) << file.name;
    EXPECT_EQ(blocks[0].width, whole.width) << file.name;
    EXPECT_EQ(blocks[0].height, whole.height) << file.name;
    EXPECT_EQ(read_cloud(path_, options).points, whole.points) << file.name;
  }
}

TEST_F(ReadCloudInBlocks, KeepsTheOriginOfTheFirstPointsForAll) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) {
    text += "432123." + std::to_string(1000 + i) + " 5123456.25 312.125\n";
  }
  write({"utm.xyz", text});
  for (const PointCloud& block : read(4500, {.window_bytes = 1000})) {
    EXPECT_EQ(block.origin, Eigen::Vector3d(432100, 5123500, 300));
    EXPECT_LT(block.points.front().cwiseAbs().maxCoeff(), 100.0F);
  }
}

// The messages are those for a file in memory.
TEST_F(ReadCloudInBlocks, RefusesTruncatedFilesAsBefore) {
  const auto message_of = [](const auto& reading) -> std::string {
    try {
      reading();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      return error.what();
    }
    return "no error";
  };
  for (testing::NamedFile file : large_files()) {
    for (const double share : {0.002, 0.3, 0.9999}) {
      testing::NamedFile cut = file;
      cut.bytes.resize(static_cast<std::size_t>(share * static_cast<double>(file.bytes.size())));
      write(cut);
      const std::string whole = message_of([&] { testing::parse(cut.bytes, path_.string()); });
      const std::string windowed = message_of([&] { read(5000, {.window_bytes = 1024}); });
      EXPECT_EQ(windowed, whole) << cut.name << " cut to " << share;
    }
  }
}

TEST_F(ReadCloudInBlocks, RefusesAWordInTheMiddleOfALargeFileAsBefore) {
  const std::vector<std::string> texts{"a.ply", "a.pcd", "a.xyz", "a.pts"};
  std::size_t read_so_far = 0;
  for (testing::NamedFile file : large_files()) {
    if (std::find(texts.begin(), texts.end(), file.name) == texts.end()) continue;
    const std::size_t middle = file.bytes.find(' ', file.bytes.size() / 2);
    file.bytes.insert(middle + 1, std::string(3000, 'x'));
    write(file);
    ++read_so_far;
    try {
      read(5000, {.window_bytes = 1024});
      ADD_FAILURE() << file.name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("xxxxxxxxxx")) << file.name;
    }
  }
  EXPECT_EQ(read_so_far, texts.size());
}

TEST_F(ReadCloudInBlocks, StopsInTheMiddleAndTellsTheBytesOfTheFile) {
  for (const testing::NamedFile& file : large_files()) {
    if (file.name == "c.pcd") continue;
    write(file);
    std::stop_source stop;
    RunContext context;
    context.stop = stop.get_token();
    std::uint64_t total = 0;
    context.progress = [&](const Progress& progress) { total = progress.total; };
    std::size_t blocks = 0;
    const CloudSink sink{5000, [&](PointCloud) {
                           if (++blocks == 2) stop.request_stop();
                         }};
    try {
      read_cloud_in_blocks(path_, {.window_bytes = 1024}, context, sink);
      ADD_FAILURE() << file.name << " was read to its end";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled) << file.name;
    }
    EXPECT_EQ(blocks, 2U) << file.name;
    EXPECT_EQ(total, file.bytes.size()) << file.name;
  }
}

// While vertices were sorted it fell back to the size of the window.
TEST_F(ReadCloudInBlocks, TellsOfAMeshNoFewerBytesThanBefore) {
  constexpr int kSide = 40;
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(kSide * kSide) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(kSide * kSide) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < kSide * kSide; ++i) {
    text += std::to_string(i % kSide) + ' ' + std::to_string(i / kSide) + " 0\n";
  }
  for (int i = 0; i < kSide * kSide; ++i) {
    text += "3 0 " + std::to_string(i) + ' ' + std::to_string(kSide * kSide - 1) + '\n';
  }
  write({"mesh.ply", text});
  std::uint64_t done = 0;
  RunContext context;
  context.progress = [&](const Progress& progress) {
    if (progress.stage != "read") return;
    EXPECT_GE(progress.done, done);
    done = progress.done;
  };
  const ReadOptions options{.mesh_spacing_m = 5.0, .window_bytes = 1024};
  read_cloud_in_blocks(path_, options, context, {.take = [](const PointCloud&) {}});
  EXPECT_EQ(done, text.size());
}

TEST_F(ReadCloudInBlocks, LetsThroughWhatTheSinkThrows) {
  write({"a.xyz", testing::xyz_text(kPoints)});
  const CloudSink sink{5000,
                       [](PointCloud) { throw Error(ErrorCode::kResourceExhausted, "full"); }};
  EXPECT_THROW(read_cloud_in_blocks(path_, {}, {}, sink), Error);
}

}  // namespace
}  // namespace landmarkdb
