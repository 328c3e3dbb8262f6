#include "engine/cloud/byte_window.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

// A file on disk, of which the first `front` bytes are in memory and `window` at a time later.
class WindowedFile {
 public:
  WindowedFile(const std::string& bytes, std::size_t front, std::size_t window)
      : path_(written(bytes)), file_(path_, bytes.size()), front_(read_front(file_, front, {})) {
    input_ = {front_.span(), file_.name(), nullptr, {&file_, window}};
  }
  ~WindowedFile() { std::filesystem::remove(path_); }
  WindowedFile(const WindowedFile&) = delete;
  WindowedFile& operator=(const WindowedFile&) = delete;

  const Input& input() const { return input_; }
  void cut_to(std::size_t bytes) const { std::filesystem::resize_file(path_, bytes); }

 private:
  static std::string written(const std::string& bytes) {
    const std::string path = ::testing::TempDir() + "byte_window_test.txt";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::string path_;
  InputFile file_;
  FileBytes front_;
  Input input_;
};

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(ByteWindow, GivesTheWholeFilePieceByPiece) {
  std::string bytes;
  for (int i = 0; i < 500; ++i) bytes += std::to_string(i);
  for (const std::size_t step : {1U, 7U, 64U, 200U}) {
    const WindowedFile file(bytes, 50, 64);
    ByteWindow window(file.input(), 3);
    std::string seen = bytes.substr(0, 3);
    while (window.left() > 0) {
      const std::span<const std::byte> ahead = window.ahead(step);
      ASSERT_GE(ahead.size(), std::min<std::size_t>(step, window.left()));
      seen += text_of(ahead.first(std::min(step, ahead.size())));
      window.skip(std::min<std::uint64_t>(step, window.left()));
    }
    EXPECT_EQ(seen, bytes) << step;
    EXPECT_EQ(window.at(), bytes.size());
    EXPECT_TRUE(window.ahead(1).empty());
  }
}

TEST(ByteWindow, PassesOverWhatItNeverReads) {
  std::string bytes(1000, 'x');
  bytes[900] = 'y';
  const WindowedFile file(bytes, 50, 64);
  ByteWindow window(file.input());
  window.skip(900);
  EXPECT_EQ(text_of(window.ahead(1).first(1)), "y");
  EXPECT_EQ(window.left(), 100U);
}

TEST(ByteWindow, EndsWhereTheFileWasCutOffMeanwhile) {
  const WindowedFile file(std::string(1000, 'x'), 50, 64);
  ByteWindow window(file.input());
  EXPECT_EQ(window.left(), 1000U);
  file.cut_to(80);
  window.skip(40);
  EXPECT_EQ(window.ahead(100).size(), 40U);
  EXPECT_EQ(window.left(), 40U);
}

// A gigabyte asked for at once took seconds to stop.
TEST(ByteWindow, AsksWhetherToGoOnOnceAWindowHoweverMuchIsWanted) {
  const WindowedFile file(std::string(1000, 'x'), 50, 64);
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  int asked = 0;
  context.progress = [&](const Progress&) {
    ++asked;
    stop.request_stop();
  };
  Input input = file.input();
  input.context = &context;
  ByteWindow window(input);
  EXPECT_THROW(window.ahead(1000), Error);
  EXPECT_EQ(asked, 1);
}

TEST(TakeWord, ReadsWordsOfAnyLengthAcrossTheEdges) {
  std::vector<std::string> words;
  std::string text;
  for (std::size_t i = 0; i < 60; ++i) {
    words.emplace_back(1 + i * i % 150, static_cast<char>('a' + i % 26));
    text += std::string(1 + i * 7 % 130, ' ') + words.back();
  }
  for (const std::size_t front : {1U, 33U, 64U}) {
    const WindowedFile file(text, front, 64);
    ByteWindow window(file.input());
    for (const std::string& word : words) ASSERT_EQ(take_word(window), word);
    EXPECT_EQ(take_word(window), "");
  }
}

// A file without any was read into memory whole, however large.
TEST(LineWindow, RefusesAFileWithoutLineEnds) {
  const std::string text = "1 2 3\n" + std::string(std::size_t{40} << 20U, '4');
  const WindowedFile file(text, 64, 64);
  LineWindow lines(file.input());
  std::string_view line;
  EXPECT_TRUE(lines.next(line));
  ByteWindow words(file.input(), 6);
  for (const auto& read :
       std::vector<std::function<void()>>{[&] { lines.next(line); }, [&] { take_word(words); }}) {
    try {
      read();
      ADD_FAILURE() << "taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_THAT(error.what(), ::testing::HasSubstr("byte_window_test.txt: "));
      EXPECT_THAT(error.what(), ::testing::HasSubstr("from byte 6 on"));
    }
  }
}

TEST(LineWindow, GivesTheLinesThatLineReaderGives) {
  std::string text = "\n\r\n\r\r\n";
  for (std::size_t i = 0; i < 200; ++i) {
    text += std::string(i * 13 % 170, static_cast<char>('a' + i % 26)) +
            std::vector<std::string>{"\n", "\r\n", "\r"}[i % 3];
  }
  text += "no end";
  for (std::size_t front = 1; front < 40; ++front) {
    const WindowedFile file(text, front, 64);
    LineWindow lines(file.input());
    LineReader whole(text);
    std::string_view line, want;
    while (whole.next(want)) {
      ASSERT_TRUE(lines.next(line));
      ASSERT_EQ(line, want) << "front " << front << ", line " << whole.number();
      ASSERT_EQ(lines.number(), whole.number());
      ASSERT_EQ(lines.at(), whole.at());
    }
    EXPECT_FALSE(lines.next(line));
  }
}

}  // namespace
}  // namespace landmarkdb
