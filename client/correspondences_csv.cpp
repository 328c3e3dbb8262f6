#include "client/correspondences_csv.hpp"

#include <array>
#include <charconv>

#include "cli/write_file.hpp"

namespace landmarkdb::client {
namespace {

// The shortest text that reads back to the same number.
template <typename Number>
void append(std::string& out, Number number) {
  std::array<char, 32> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), number);
  out.append(text.data(), end.ptr);
  out += ',';
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

}  // namespace

std::string correspondences_csv(const std::vector<CorrespondenceRecord>& pairs) {
  std::string out =
      "scene,sensor_x_m,sensor_y_m,sensor_z_m,scene_x_m,scene_y_m,scene_z_m,distance,dropped_by\n";
  for (const CorrespondenceRecord& pair : pairs) {
    out += quoted(pair.scene) + ',';
    for (const float number : pair.sensor_m) append(out, number);
    for (const double number : pair.scene_m) append(out, number);
    append(out, pair.distance);
    out += quoted(pair.dropped_by) + '\n';
  }
  return out;
}

void write_correspondences(const std::filesystem::path& path,
                           const std::vector<CorrespondenceRecord>& pairs) {
  cli::write_file(path, correspondences_csv(pairs), "--correspondences");
}

}  // namespace landmarkdb::client
