#include "proto/framing.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> read_all(FrameReader& reader) {
  std::vector<std::string> frames;
  for (Frame frame = reader.next(); frame.status == FrameStatus::kFrame; frame = reader.next()) {
    frames.emplace_back(frame.payload);
  }
  return frames;
}

std::string header(std::uint32_t length) {
  std::string bytes(kFrameHeaderBytes, '\0');
  write_frame_header(length, bytes.data());
  return bytes;
}

TEST(EncodeFrame, PutsTheLengthInFrontMostSignificantByteFirst) {
  EXPECT_EQ(encode_frame("abc"), std::string("\0\0\0\3abc", 7));
  EXPECT_EQ(header(0x01020304), "\x01\x02\x03\x04");
}

TEST(FrameReader, GivesTheFramesBackWhereverTheStreamIsSplit) {
  const std::string stream =
      encode_frame("first") + encode_frame(std::string(300, 'x')) + encode_frame("z");
  for (std::size_t split = 0; split <= stream.size(); ++split) {
    FrameReader reader(1000);
    std::vector<std::string> frames;
    for (const std::string& part : {stream.substr(0, split), stream.substr(split)}) {
      reader.feed(part);
      for (std::string& frame : read_all(reader)) frames.push_back(std::move(frame));
    }
    ASSERT_THAT(frames, ElementsAre("first", std::string(300, 'x'), "z")) << "split at " << split;
    ASSERT_FALSE(reader.in_frame());
  }
}

TEST(FrameReader, GivesTheFramesBackByteByByte) {
  FrameReader reader(1000);
  std::vector<std::string> frames;
  for (const char byte : encode_frame("one") + encode_frame("two")) {
    reader.feed(std::string_view(&byte, 1));
    for (std::string& frame : read_all(reader)) frames.push_back(std::move(frame));
  }
  EXPECT_THAT(frames, ElementsAre("one", "two"));
}

TEST(FrameReader, TakesAFrameOfExactlyTheLimit) {
  FrameReader reader(5);
  reader.feed(encode_frame("12345"));
  EXPECT_THAT(read_all(reader), ElementsAre("12345"));
}

TEST(FrameReader, RefusesALengthOverTheLimitAsSoonAsItIsKnown) {
  FrameReader reader(5);
  reader.feed(header(6).substr(0, 3));
  EXPECT_EQ(reader.next().status, FrameStatus::kNeedMore);
  reader.feed(header(6).substr(3));
  const Frame frame = reader.next();
  EXPECT_EQ(frame.status, FrameStatus::kTooLong);
  EXPECT_EQ(frame.announced_bytes, 6U);
}

TEST(FrameReader, TakesNothingMoreAfterABadLength) {
  FrameReader reader(5);
  reader.feed(header(0xffffffff));
  EXPECT_EQ(reader.next().status, FrameStatus::kTooLong);
  const std::size_t held = reader.buffered_bytes();
  reader.feed(encode_frame("good"));
  EXPECT_EQ(reader.next().status, FrameStatus::kTooLong);
  EXPECT_EQ(reader.buffered_bytes(), held);
}

TEST(FrameReader, RefusesAnEmptyFrame) {
  FrameReader reader(5);
  reader.feed(encode_frame(""));
  EXPECT_EQ(reader.next().status, FrameStatus::kEmpty);
}

TEST(FrameReader, HoldsNoMoreThanWhatArrived) {
  FrameReader reader(kLargestMessageBytes);
  reader.feed(header(kLargestMessageBytes) + "abc");
  const Frame frame = reader.next();
  EXPECT_EQ(frame.status, FrameStatus::kNeedMore);
  EXPECT_EQ(frame.announced_bytes, kLargestMessageBytes);
  EXPECT_EQ(reader.buffered_bytes(), kFrameHeaderBytes + 3);
}

TEST(FrameReader, AppliesANewLimitToFramesNotYetHandedOut) {
  FrameReader reader(5);
  reader.feed(encode_frame("hello") + encode_frame("long enough"));
  ASSERT_EQ(reader.next().status, FrameStatus::kFrame);
  reader.set_limit(100);
  const Frame frame = reader.next();
  ASSERT_EQ(frame.status, FrameStatus::kFrame);
  EXPECT_EQ(frame.payload, "long enough");
}

TEST(FrameReader, SurvivesGarbage) {
  Random random(7);
  for (int round = 0; round < 2000; ++round) {
    FrameReader reader(4096);
    std::size_t fed = 0;
    for (int part = 0; part < 8; ++part) {
      std::string bytes(random.below(600), '\0');
      // Small values in the length, so that some garbage passes for frames.
      for (char& byte : bytes) byte = static_cast<char>(random.below(random.below(3) ? 3 : 256));
      fed += bytes.size();
      reader.feed(bytes);
      for (Frame frame = reader.next(); frame.status == FrameStatus::kFrame;
           frame = reader.next()) {
        ASSERT_LE(frame.payload.size(), 4096U);
        ASSERT_GT(frame.payload.size(), 0U);
      }
      ASSERT_LE(reader.buffered_bytes(), fed);
    }
  }
}

}  // namespace
}  // namespace landmarkdb
