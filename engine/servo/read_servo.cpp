#include "engine/servo/read_servo.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <span>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestFile = 256 * 1024;  // a six-joint arm has about 2 kB
constexpr int kDeepest = 8;                       // of nested lists and objects; four are in use
constexpr std::size_t kMostListed = 32;           // of any list; as check_arm
constexpr double kMostCycles = 1000.0;

// One object of the file, and where it stands for messages: "arm.json: joints[2]".
class Section {
 public:
  Section(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) refuse("is " + shown(json) + ", want an object {...}");
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::kInvalidArgument, where_ + ": " + what);
  }

  // Refuses every key that is not among `known`.
  void allow(std::initializer_list<const char*> known) const {
    for (const auto& [key, value] : json_.items()) {
      const bool found = std::any_of(
          known.begin(), known.end(), [&key = key](const char* name) { return key == name; });
      if (found) continue;
      std::string all;
      for (const char* name : known) all += std::string(all.empty() ? "" : ", ") + name;
      refuse("does not know \"" + key.substr(0, 40) + "\", want only " + all);
    }
  }

  bool has(const char* key) const { return json_.contains(key); }

  const Json& need(const char* key) const {
    if (!has(key)) refuse(std::string("has no ") + key);
    return json_[key];
  }

  double number(const char* key) const { return number_of(need(key), key); }
  double number(const char* key, double otherwise) const {
    return has(key) ? number(key) : otherwise;
  }

  // A number, or null for "none".
  double number_or_none(const char* key, double none) const {
    return need(key).is_null() ? none : number(key);
  }

  std::size_t count(const char* key, std::size_t otherwise) const {
    if (!has(key)) return otherwise;
    const double value = number(key);
    if (!(value >= 0.0 && value <= kMostCycles && value == std::floor(value))) {
      refuse(std::string(key) + " is " + shown(need(key)) + ", want a whole number from 0 to 1000");
    }
    return static_cast<std::size_t>(value);
  }

  bool flag(const char* key, bool otherwise) const {
    if (!has(key)) return otherwise;
    if (!need(key).is_boolean()) {
      refuse(std::string(key) + " is " + shown(need(key)) + ", want true or false");
    }
    return need(key).get<bool>();
  }

  std::string text(const char* key) const {
    if (!need(key).is_string()) {
      refuse(std::string(key) + " is " + shown(need(key)) + ", want a text");
    }
    return need(key).get<std::string>();
  }

  const Json& list(const char* key) const {
    const Json& value = need(key);
    if (!value.is_array() || value.size() > kMostListed) {
      refuse(std::string(key) + " is " + shown(value) + ", want a list of at most 32");
    }
    return value;
  }

  std::vector<double> numbers(const char* key) const {
    std::vector<double> values;
    for (const Json& item : list(key)) values.push_back(number_of(item, key));
    return values;
  }

  Eigen::Isometry3d pose(const char* key) const {
    const std::vector<double> values = numbers(key);
    if (values.size() != 16) {
      refuse(std::string(key) + " has " + std::to_string(values.size()) +
             " numbers, want 16: 4 x 4, row by row");
    }
    try {
      return from_row_major(std::span<const double, 16>(values.data(), 16));
    } catch (const Error& error) {
      refuse(std::string(key) + ": " + error.what());
    }
  }

  std::string place(const char* key, std::size_t i) const {
    return where_ + ": " + key + "[" + std::to_string(i) + "]";
  }

 private:
  static std::string shown(const Json& value) {
    constexpr std::size_t kShown = 40;
    if (value.is_array()) return "a list of " + std::to_string(value.size());
    if (value.is_object()) return "an object";
    return value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, kShown);
  }

  double number_of(const Json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      refuse(std::string(key) + " is " + shown(value) + ", want a finite number");
    }
    return value.get<double>();
  }

  const Json& json_;
  std::string where_;
};

ArmJoint take_joint(const Section& section) {
  section.allow({"a", "alpha", "d", "offset", "min", "max", "rate"});
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {.a_m = section.number("a"),
          .alpha_rad = section.number("alpha"),
          .d_m = section.number("d"),
          .offset_rad = section.number("offset", 0.0),
          .min_rad = section.number_or_none("min", -kNone),
          .max_rad = section.number_or_none("max", kNone),
          .max_rate_rad_s = section.number_or_none("rate", kNone)};
}

SecondaryTask take_secondary(const Section& section, std::size_t joints) {
  section.allow({"task", "gain", "margin", "joints", "angles"});
  const std::string kind = section.text("task");
  SecondaryTask task;
  task.gain_per_s = section.number("gain", task.gain_per_s);
  if (kind == "joint_limits") {
    task.margin = section.number("margin", task.margin);
    return task;
  }
  if (kind != "posture") {
    section.refuse("task is \"" + kind.substr(0, 40) + "\", want joint_limits or posture");
  }
  task.kind = SecondaryKind::kPosture;
  task.posture_rad = section.numbers("angles");
  for (const double joint : section.numbers("joints")) {
    if (!(joint >= 1.0 && joint <= static_cast<double>(joints) && joint == std::floor(joint))) {
      section.refuse("joints names one that the arm does not have, want 1 to " +
                     std::to_string(joints));
    }
    task.joints.push_back(static_cast<Eigen::Index>(joint) - 1);
  }
  return task;
}

void take_options(const Section& file, ServoOptions& options) {
  options.T_camera_object = file.pose("T_camera_object");
  options.gain_per_s = file.number("gain", options.gain_per_s);
  options.cycle_s = file.number("cycle_s", options.cycle_s);
  options.delay_cycles = file.count("delay_cycles", options.delay_cycles);
  options.hold_cycles = file.count("hold_cycles", options.hold_cycles);
  options.feed_forward = file.flag("feed_forward", options.feed_forward);
  options.observer_memory = file.number("observer_memory", options.observer_memory);
  if (!file.has("secondary")) return;
  options.secondary.clear();
  const Json& list = file.list("secondary");
  for (std::size_t i = 0; i < list.size(); ++i) {
    options.secondary.push_back(
        take_secondary(Section(list[i], file.place("secondary", i)), options.arm.joints.size()));
  }
}

ServoFile take_file(const Json& json, std::string_view name) {
  const Section file(json, std::string(name));
  file.allow({"name",
              "joints",
              "T_flange_camera",
              "T_camera_object",
              "q",
              "gain",
              "cycle_s",
              "delay_cycles",
              "hold_cycles",
              "symmetry",
              "feed_forward",
              "observer_memory",
              "secondary"});
  ServoFile result;
  if (file.has("name")) result.name = file.text("name");
  const Json& joints = file.list("joints");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    result.options.arm.joints.push_back(take_joint(Section(joints[i], file.place("joints", i))));
  }
  result.options.arm.T_flange_camera = file.pose("T_flange_camera");
  take_options(file, result.options);
  try {
    if (file.has("symmetry")) {
      result.options.symmetry = parse_servo_symmetry(file.text("symmetry"));
      result.symmetry_given = true;
    }
    check_servo_options(result.options);
    if (file.has("q")) {
      const std::vector<double> q = file.numbers("q");
      result.q = Eigen::Map<const JointVector>(q.data(), static_cast<Eigen::Index>(q.size()));
      check_joint_angles(result.options.arm, *result.q);
    }
  } catch (const Error& error) {
    const std::string said = error.what();
    if (said.starts_with(name)) throw;  // one of ours, which names its key already
    file.refuse(said);
  }
  return result;
}

}  // namespace

ServoFile parse_servo(const std::string& text, std::string_view name) {
  const auto refuse = [name](const std::string& what) {
    throw Error(ErrorCode::kInvalidArgument, std::string(name) + ": " + what);
  };
  if (text.size() > kLongestFile) {
    refuse("has " + std::to_string(text.size()) + " bytes, want at most " +
           std::to_string(kLongestFile) + " for an arm file");
  }
  const auto bounded = [](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepest) throw std::invalid_argument("nested too deeply");
    return true;
  };
  Json json;
  try {
    json = Json::parse(text, bounded);
  } catch (const std::exception& error) {
    refuse(std::string("is no JSON: ") + error.what());
  }
  return take_file(json, name);
}

ServoFile read_servo(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    throw Error(ErrorCode::kInvalidArgument, name + ": is not a regular file");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    throw Error(ErrorCode::kInvalidArgument, name + ": cannot be read: " + std::strerror(errno));
  }
  // One byte more than allowed is enough to see that a file is too long.
  std::string text(kLongestFile + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_servo(text, name);
}

}  // namespace landmarkdb
