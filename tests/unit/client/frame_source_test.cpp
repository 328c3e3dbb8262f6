#include "client/frame_source.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class FrameSourceTest : public ::testing::Test {
 protected:
  FrameSourceTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "frames-XXXXXX").string();
    folder = ::mkdtemp(pattern.data());
  }
  ~FrameSourceTest() override { std::filesystem::remove_all(folder); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
  static std::vector<std::string> names_of(const std::string& source) {
    const std::unique_ptr<FrameSource> frames = open_frames(source, {});
    std::vector<std::string> names;
    while (frames->advance()) {
      names.push_back(std::filesystem::path(frames->name()).filename());
    }
    return names;
  }

  std::filesystem::path folder;
};

TEST_F(FrameSourceTest, TakesTheImagesOfAFolderByTheirNumbers) {
  for (const char* name : {"f10.png", "f2.png", "f1.PGM", "notes.txt"}) write(name, "x");
  EXPECT_THAT(names_of(folder), ElementsAre("f1.PGM", "f2.png", "f10.png"));
  EXPECT_THAT(names_of(folder / "f*.png"), ElementsAre("f2.png", "f10.png"));
  EXPECT_THAT(names_of(folder / "f2.png"), ElementsAre("f2.png"));
  EXPECT_EQ(open_frames(folder, {})->total(), 3U);
}

TEST_F(FrameSourceTest, RefusesASourceThatIsNotThere) {
  EXPECT_THROW(open_frames(folder / "none.png", {}), Error);
  EXPECT_THROW(open_frames(folder / "none*.png", {}), Error);
  EXPECT_THROW(open_frames(folder, {}), Error) << "no image is in it";
}

TEST_F(FrameSourceTest, AnEmptyImageIsRefusedAndTheNextIsRead) {
  write("a.png", "");
  write("b.png", "bytes");
  const std::unique_ptr<FrameSource> frames = open_frames(folder, {});
  ASSERT_TRUE(frames->advance());
  EXPECT_THROW(frames->load(), Error);
  ASSERT_TRUE(frames->advance());
  EXPECT_EQ(frames->load().image, "bytes");
  EXPECT_FALSE(frames->advance());
}

TEST_F(FrameSourceTest, ReadsLinesToTheLastWhichNeedsNoEnd) {
  const std::string long_line(200'000, ' ');
  const std::string path = write("points.jsonl",
                                 R"({"points": [{"uv": [1, 2]}]})"
                                 "\n\n" +
                                     long_line + R"({"points": [], "frame": "last", "time_s": 2})");
  const std::unique_ptr<FrameSource> frames = open_frames(path, {});
  ASSERT_TRUE(frames->advance());
  EXPECT_THAT(frames->load().points, SizeIs(1));
  EXPECT_THAT(frames->name(), HasSubstr("points.jsonl line 1"));
  ASSERT_TRUE(frames->advance());
  EXPECT_THAT(frames->name(), HasSubstr("line 3"));
  EXPECT_EQ(frames->load().time_s, 2.0);
  EXPECT_EQ(frames->name(), "last");
  EXPECT_FALSE(frames->advance());
}

TEST_F(FrameSourceTest, EndsWhenStopped) {
  std::stop_source stop;
  stop.request_stop();
  const std::unique_ptr<FrameSource> frames =
      open_frames(write("a.png", "bytes"), stop.get_token());
  EXPECT_THROW(frames->advance(), Error);
}

TEST(ParseFrame, TakesPointsJointsAndTime) {
  std::string name = "line 1";
  const TrackInput input = parse_frame(R"({"frame": 7, "points": [{"uv": [1, 2]},
      {"type": "centroid", "uv": [3, 4]}], "links": [[0, 1]], "q": [0.5, 1], "q_at_image": [0, 1],
      "time_s": 3.25})",
                                       name);
  EXPECT_EQ(name, "7");
  EXPECT_THAT(input.points, SizeIs(2));
  EXPECT_THAT(input.links, SizeIs(1));
  EXPECT_THAT(input.q_rad, ElementsAre(0.5, 1.0));
  EXPECT_THAT(input.q_at_image_rad, ElementsAre(0.0, 1.0));
  EXPECT_EQ(input.time_s, 3.25);
}

TEST(ParseFrame, NamesTheLineAtFault) {
  for (const char* line : {"{",
                           "[]",
                           "{}",
                           R"({"points": [], "image": "a.png"})",
                           R"({"image": 3})",
                           R"({"image": "/nowhere/at/all.png"})",
                           R"({"points": [{"uv": [1]}]})",
                           R"({"points": [], "q": 1})",
                           R"({"points": [], "q": [1, null]})",
                           R"({"points": [], "time_s": "now"})",
                           R"({"points": [], "frame": {}})"}) {
    std::string name = "line 4";
    try {
      parse_frame(line, name);
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_THAT(error.what(), ::testing::AnyOf(HasSubstr("line 4"), HasSubstr("/nowhere")));
    }
  }
}

TEST(NaturalLess, OrdersRunsOfDigitsByTheirValue) {
  EXPECT_TRUE(natural_less("f2", "f10"));
  EXPECT_FALSE(natural_less("f10", "f2"));
  EXPECT_TRUE(natural_less("f9.png", "f010.png"));
  EXPECT_TRUE(natural_less("a1", "a1b"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_TRUE(natural_less("a01", "a1") != natural_less("a1", "a01"));
  EXPECT_FALSE(natural_less("a1", "a1"));
}

}  // namespace
}  // namespace landmarkdb::client
