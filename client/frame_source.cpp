#include "client/frame_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <glob.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

#include "client/read_points.hpp"
#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb::client {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::uint64_t kMaxImageBytes = std::uint64_t{256} << 20U;
constexpr std::size_t kMaxLineBytes = std::size_t{32} << 20U;
constexpr std::size_t kMaxJoints = 32;  // of any arm

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, name + ": " + what);
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool is_one_of(const std::string& extension, std::initializer_list<std::string_view> known) {
  return std::find(known.begin(), known.end(), extension) != known.end();
}

std::string read_image_file(const std::string& path) {
  const FileBytes file = read_whole_file(path, kMaxImageBytes);
  if (file.size == 0) refuse(path, "is empty, want a PNG, JPEG or PGM image");
  return {reinterpret_cast<const char*>(file.data.get()), file.size};
}

class ImageFiles : public FrameSource {
 public:
  ImageFiles(std::vector<std::string> paths, std::stop_token stop)
      : paths_(std::move(paths)), stop_(std::move(stop)) {}

  bool advance() override {
    if (stop_.stop_requested()) throw Error(ErrorCode::kCancelled, "interrupted between frames");
    if (next_ == paths_.size()) return false;
    ++next_;
    return true;
  }
  const std::string& name() const override { return paths_[next_ - 1]; }
  TrackInput load() override {
    TrackInput input;
    input.image = read_image_file(name());
    return input;
  }
  std::uint64_t total() const override { return paths_.size(); }

 private:
  std::vector<std::string> paths_;
  std::stop_token stop_;
  std::size_t next_ = 0;
};

// Lines of a file or of standard input, as they come.
class Lines : public FrameSource {
 public:
  Lines(int fd, std::string source, std::stop_token stop)
      : fd_(fd), source_(std::move(source)), stop_(std::move(stop)) {}
  ~Lines() override {
    if (fd_ != STDIN_FILENO) ::close(fd_);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  bool advance() override {
    while (next_line()) {
      ++number_;
      if (line_.find_first_not_of(" \t\r") == std::string::npos) continue;
      name_ = source_ + " line " + std::to_string(number_);
      return true;
    }
    return false;
  }
  const std::string& name() const override { return name_; }
  TrackInput load() override { return parse_frame(line_, name_); }
  std::uint64_t total() const override { return 0; }

 private:
  bool next_line() {
    std::size_t searched = 0;
    while (true) {
      const std::size_t end = buffer_.find('\n', searched);
      if (end != std::string::npos || (ended_ && !buffer_.empty())) {
        line_ = buffer_.substr(0, end);
        buffer_.erase(0, end == std::string::npos ? end : end + 1);
        return true;
      }
      if (ended_) return false;
      if (buffer_.size() > kMaxLineBytes) {
        refuse(source_,
               "line " + std::to_string(number_ + 1) + " is longer than " +
                   std::to_string(kMaxLineBytes) + " bytes");
      }
      searched = buffer_.size();
      read_more();
    }
  }

  void read_more() {
    if (stop_.stop_requested()) throw Error(ErrorCode::kCancelled, "interrupted between frames");
    constexpr int kPatience_ms = 100;  // how soon Ctrl-C is noticed
    pollfd wait{fd_, POLLIN, 0};
    while (::poll(&wait, 1, kPatience_ms) <= 0) {
      if (stop_.stop_requested()) {
        throw Error(ErrorCode::kCancelled, "interrupted while waiting for a frame");
      }
    }
    std::array<char, std::size_t{64} * 1024> chunk{};
    const ssize_t got = ::read(fd_, chunk.data(), chunk.size());
    if (got < 0 && errno != EINTR && errno != EAGAIN) {
      refuse(source_, std::string("cannot be read: ") + std::strerror(errno));
    }
    if (got == 0) ended_ = true;
    if (got > 0) buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  }

  int fd_;
  std::string source_;
  std::stop_token stop_;
  std::string buffer_;  // read, and not yet handed out
  std::string line_;
  std::string name_;
  std::uint64_t number_ = 0;
  bool ended_ = false;
};

std::vector<std::string> images_in(const std::string& folder) {
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string extension = lower_extension(entry.path());
    if (entry.is_regular_file() &&
        is_one_of(extension, {".png", ".jpg", ".jpeg", ".pgm", ".ppm"})) {
      paths.push_back(entry.path().string());
    }
  }
  if (paths.empty()) refuse(folder, "has no PNG, JPEG, PGM or PPM image in it");
  return paths;
}

std::vector<std::string> files_like(const std::string& pattern) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> paths(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  if (status == GLOB_NOMATCH) refuse(pattern, "no file is called like this");
  if (status != 0) refuse(pattern, "cannot be looked up");
  return paths;
}

std::vector<double> angles_of(const Json& json, const char* key, const std::string& name) {
  if (!json.contains(key)) return {};
  const Json& list = json[key];
  if (!list.is_array() || list.size() > kMaxJoints) {
    refuse(name, std::string("\"") + key + "\" is no list of at most 32 joint angles");
  }
  std::vector<double> angles;
  for (const Json& angle : list) {
    if (!angle.is_number() || !std::isfinite(angle.get<double>())) {
      refuse(
          name,
          std::string("\"") + key + "\" has " + in_quotes(angle.dump()) + ", want finite numbers");
    }
    angles.push_back(angle.get<double>());
  }
  return angles;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (j < b.size() && b[j] == '0') ++j;
    const std::size_t from_i = i;
    const std::size_t from_j = j;
    while (i < a.size() && digit(a[i])) ++i;
    while (j < b.size() && digit(b[j])) ++j;
    if (i - from_i != j - from_j) return i - from_i < j - from_j;
    const int order = a.compare(from_i, i - from_i, b, from_j, j - from_j);
    if (order != 0) return order < 0;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;  // the same but for leading zeros
}

TrackInput parse_frame(std::string_view line, std::string& name) {
  Json json;
  try {
    json = Json::parse(line);
  } catch (const Json::exception& error) {
    refuse(name, std::string("is not valid JSON: ") + error.what());
  }
  if (!json.is_object()) refuse(name, std::string("is a ") + json.type_name() + ", want an object");
  if (json.contains("frame")) {
    const Json& given = json["frame"];
    if (!given.is_string() && !given.is_number_integer()) {
      refuse(name, "\"frame\" is no name and no number");
    }
    name = given.is_string() ? given.get<std::string>() : given.dump();
  }
  TrackInput input;
  if (json.contains("image") == json.contains("points")) {
    refuse(name, "want \"points\" or \"image\", and not both");
  }
  if (json.contains("image")) {
    if (!json["image"].is_string()) refuse(name, "\"image\" is no file name");
    input.image = read_image_file(json["image"].get<std::string>());
  } else {
    RecognizeInput read;
    take_points(json, name, read);
    input.points = std::move(read.points);
    input.links = std::move(read.links);
  }
  if (json.contains("time_s")) {
    if (!json["time_s"].is_number()) refuse(name, "\"time_s\" is no number");
    input.time_s = json["time_s"].get<double>();
  }
  input.q_rad = angles_of(json, "q", name);
  input.q_at_image_rad = angles_of(json, "q_at_image", name);
  return input;
}

std::unique_ptr<FrameSource> open_frames(const std::string& source, std::stop_token stop) {
  if (source == "-") {
    return std::make_unique<Lines>(STDIN_FILENO, "standard input", std::move(stop));
  }
  std::error_code ignored;
  const bool there = fs::exists(source, ignored);
  if (there && is_one_of(lower_extension(source), {".json", ".jsonl", ".ndjson"})) {
    // Not blocked by a pipe that nobody has opened for writing yet.
    const int fd = ::open(source.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) refuse(source, std::string("cannot be read: ") + std::strerror(errno));
    return std::make_unique<Lines>(fd, source, std::move(stop));
  }
  std::vector<std::string> paths{source};
  try {
    if (fs::is_directory(source, ignored)) {
      paths = images_in(source);
    } else if (!there && source.find_first_of("*?[") != std::string::npos) {
      paths = files_like(source);
    }
  } catch (const fs::filesystem_error& error) {
    refuse(source, std::string("cannot be listed: ") + error.code().message());
  }
  if (!there && paths.size() == 1 && paths[0] == source) refuse(source, "there is no such file");
  std::sort(paths.begin(), paths.end(), natural_less);
  return std::make_unique<ImageFiles>(std::move(paths), std::move(stop));
}

}  // namespace landmarkdb::client
