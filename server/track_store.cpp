#include "server/track_store.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/stage_timings.hpp"
#include "engine/mono/tracker.hpp"
#include "engine/servo/read_servo.hpp"
#include "server/convert_recognition.hpp"
#include "server/convert_track.hpp"
#include "server/decode_image.hpp"
#include "server/servo_symmetry.hpp"

namespace landmarkdb {
namespace {

std::shared_ptr<const MonoModelRecord> find_model(const std::string& name,
                                                  const MonoCatalog& catalog) {
  for (const MonoCatalogEntry& entry : catalog.entries) {
    if (entry.record->model.name == name) return entry.record;
  }
  throw Error(ErrorCode::kNotFound, "there is no model '" + name + "'", "model");
}

// The control law and what the joints are assumed to be where nobody measures them.
struct ServoLoop {
  Servo servo;
  std::optional<JointVector> q;
};

std::optional<ServoLoop> make_loop(const std::string& text, const MonoModel& model) {
  if (text.empty()) return std::nullopt;
  try {
    ServoFile file = parse_servo(text, "servo");
    if (!file.symmetry_given) file.options.symmetry = servo_symmetry_of(model);
    return ServoLoop{Servo(std::move(file.options)), std::move(file.q)};
  } catch (const Error& error) {
    throw Error(error.code(), error.what(), "servo");
  }
}

}  // namespace

class TrackStore::Track {
 public:
  Track(const v1::TrackOpenRequest& request, const Served& served)
      : camera_(from_proto(request.camera())),
        record_(find_model(request.model(), *served.models)),
        recognizer_(served.recognizer),
        tracker_(record_, camera_, from_proto(request.options()), recognizer_.get()),
        loop_(make_loop(request.servo(), record_->model)) {
    if (const auto start = pose_from(request.start_t_camera_object(), "start_t_camera_object")) {
      tracker_.start_from(*start);
    }
  }

  std::uint64_t frames() const { return frames_; }
  const Servo* servo() const { return loop_ ? &loop_->servo : nullptr; }

  v1::TrackFrameResult next(const v1::TrackFrameRequest& request,
                            MemoryBudget& memory,
                            const RunContext& context) {
    StageTimings::Duration load{};
    StageTimings::Duration track{};
    StageTimings::Duration servo{};
    check_time(request);
    const std::optional<ServoInput> arm = joints(request);
    const TrackResult result = look(request, memory, context, load, track);
    ++frames_;
    v1::TrackFrameResult reply = to_proto(result);
    reply.set_frame(frames_);
    if (request.has_time_s()) {
      time_s_ = request.time_s();
      reply.set_time_s(request.time_s());
    }
    if (arm) {
      const StageTimer timer(servo);
      *reply.mutable_servo() = step(*arm, result);
    }
    v1::TrackTimings& timing = *reply.mutable_timing();
    timing.set_load_ms(load.count());
    timing.set_track_ms(track.count());
    timing.set_servo_ms(servo.count());
    timing.set_total_ms((load + track + servo).count());
    return reply;
  }

 private:
  void check_time(const v1::TrackFrameRequest& request) const {
    if (!request.has_time_s()) return;
    const double time_s = request.time_s();
    if (std::isfinite(time_s) && (!time_s_ || time_s > *time_s_)) return;
    throw Error(ErrorCode::kInvalidArgument,
                "time_s: is " + std::to_string(time_s) + ", want a finite number" +
                    (time_s_ ? " above that of the frame before, " + std::to_string(*time_s_) : ""),
                "time_s");
  }

  // Before anything is computed, so that a frame that is refused changes nothing.
  std::optional<ServoInput> joints(const v1::TrackFrameRequest& request) const {
    if (!loop_) {
      if (request.q_rad().empty() && request.q_at_image_rad().empty()) return std::nullopt;
      throw Error(ErrorCode::kInvalidArgument,
                  "q_rad: there are joint angles, but the track was opened without an arm",
                  "q_rad");
    }
    const Arm& arm = loop_->servo.options().arm;
    ServoInput input;
    const std::optional<JointVector> measured = joints_from(request.q_rad(), arm, "q_rad");
    if (!measured && !loop_->q) {
      throw Error(ErrorCode::kInvalidArgument,
                  "q_rad: the joint angles are neither in the frame nor, as \"q\", in the arm file",
                  "q_rad");
    }
    input.q = measured ? *measured : *loop_->q;
    input.q_at_image = joints_from(request.q_at_image_rad(), arm, "q_at_image_rad");
    return input;
  }

  TrackResult look(const v1::TrackFrameRequest& request,
                   MemoryBudget& memory,
                   const RunContext& context,
                   StageTimings::Duration& load,
                   StageTimings::Duration& track) {
    if (request.input_case() == v1::TrackFrameRequest::INPUT_NOT_SET) {
      throw Error(ErrorCode::kInvalidArgument, "there is neither an image nor points", "image");
    }
    if (request.has_points()) {
      std::optional<StageTimer> timer(std::in_place, load);
      const ImageFeatures features = from_proto(request.points(), camera_);
      timer.emplace(track);
      return tracker_.next(features, context);
    }
    const MemoryBudget::Lease lease = reserve_image(camera_, memory);
    std::optional<StageTimer> timer(std::in_place, load);
    const GreyImage image = decode_image(request.image(), camera_);
    timer.emplace(track);
    return tracker_.next(image, context);
  }

  v1::ServoCommand step(ServoInput input, const TrackResult& result) {
    if (result.measured()) input.T_camera_object = result.T_camera_object;
    const ServoCommand command = loop_->servo.step(input);
    loop_->q = input.q + loop_->servo.options().cycle_s * command.joint_rates;
    return to_proto(command, input.q);
  }

  Camera camera_;
  std::shared_ptr<const MonoModelRecord> record_;
  std::shared_ptr<const Recognizer> recognizer_;  // of the catalogue at that time
  Tracker tracker_;
  std::optional<ServoLoop> loop_;
  std::optional<double> time_s_;
  std::uint64_t frames_ = 0;
};

TrackStore::TrackStore(Counters& counters) : counters_(counters) {}
TrackStore::~TrackStore() { counters_.tracks_open -= tracks_.size(); }

v1::TrackOpenReply TrackStore::open(const v1::TrackOpenRequest& request, const Served& served) {
  if (tracks_.size() >= kMaxTracks) {
    throw Error(ErrorCode::kResourceExhausted,
                std::to_string(tracks_.size()) +
                    " tracks are open on this connection, no more are taken: close one, or open "
                    "another connection");
  }
  auto track = std::make_unique<Track>(request, served);
  v1::TrackOpenReply reply;
  reply.set_track(next_);
  reply.set_generation(served.generation);
  if (const Servo* servo = track->servo()) {
    reply.set_joints(static_cast<std::uint32_t>(servo->options().arm.joints.size()));
    reply.set_symmetry(to_string(servo->options().symmetry));
  }
  tracks_.emplace(next_, std::move(track));
  ++next_;
  ++counters_.tracks_open;
  return reply;
}

TrackStore::Track& TrackStore::find(std::uint32_t track) {
  const auto found = tracks_.find(track);
  if (found != tracks_.end()) return *found->second;
  throw Error(ErrorCode::kNotFound,
              "no track " + std::to_string(track) + " is open on this connection",
              "track");
}

v1::TrackFrameResult TrackStore::next(const v1::TrackFrameRequest& request,
                                      MemoryBudget& memory,
                                      const RunContext& context) {
  return find(request.track()).next(request, memory, context);
}

v1::TrackCloseReply TrackStore::close(const v1::TrackCloseRequest& request) {
  v1::TrackCloseReply reply;
  reply.set_frames(find(request.track()).frames());
  tracks_.erase(request.track());
  --counters_.tracks_open;
  return reply;
}

}  // namespace landmarkdb
