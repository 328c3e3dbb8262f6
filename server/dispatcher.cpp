#include "server/dispatcher.hpp"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"

namespace landmarkdb {

namespace {

double milliseconds(Job::Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

void add_query_fields(const v1::QueryResult& result, std::vector<LogField>& fields) {
  const std::string status = v1::QueryStatus_Name(result.status());
  fields.push_back({"verdict", status.substr(std::string("QUERY_STATUS_").size())});
  if (!result.hypotheses().empty()) {
    fields.push_back({"scene", result.hypotheses(0).scene()});
    fields.push_back({"confidence", result.hypotheses(0).confidence()});
  }
  fields.push_back({"points", result.query().points()});
  const v1::StageTimings& t = result.timing();
  fields.push_back({"load_ms", t.load_ms()});
  fields.push_back({"preprocess_ms", t.preprocess_ms()});
  fields.push_back({"keypoints_ms", t.keypoints_ms()});
  fields.push_back({"describe_ms", t.describe_ms()});
  fields.push_back({"match_ms", t.match_ms()});
  fields.push_back({"filter_ms", t.filter_ms()});
  fields.push_back({"pose_ms", t.pose_ms()});
  fields.push_back({"icp_ms", t.icp_ms()});
  fields.push_back({"verify_ms", t.verify_ms()});
}

void add_recognize_fields(const v1::RecognizeResult& result, std::vector<LogField>& fields) {
  const std::string status = v1::RecognizeStatus_Name(result.status());
  fields.push_back({"verdict", status.substr(std::string("RECOGNIZE_STATUS_").size())});
  if (!result.hypotheses().empty()) {
    fields.push_back({"model", result.hypotheses(0).model()});
    fields.push_back({"confidence", result.hypotheses(0).confidence()});
  }
  fields.push_back({"image_points", result.image_points()});
  fields.push_back({"features_ms", result.timing().features_ms()});
  fields.push_back({"lookup_ms", result.timing().lookup_ms()});
  fields.push_back({"verify_ms", result.timing().verify_ms()});
  fields.push_back({"refine_ms", result.timing().refine_ms()});
}

void add_track_fields(const v1::TrackFrameResult& result, std::vector<LogField>& fields) {
  const std::string status = v1::TrackStatus_Name(result.status());
  fields.push_back({"verdict", status.substr(std::string("TRACK_STATUS_").size())});
  fields.push_back({"frame", result.frame()});
  fields.push_back({"load_ms", result.timing().load_ms()});
  fields.push_back({"track_ms", result.timing().track_ms()});
}

}  // namespace

void Dispatcher::submit(const std::shared_ptr<Job>& job, Answer answer) {
  const Lane lane = lane_of(job->request);
  if (lane == Lane::kInline) {
    run(*job, answer);
    return;
  }
  if (!enqueue(lane, job, answer)) turn_away(*job, answer);
}

void Dispatcher::turn_away(Job& job, const Answer& answer) {
  if (!job.claim()) return;
  ++counters_.rejected_total;
  answer(refuse(job,
                ErrorCode::kResourceExhausted,
                "too many requests are waiting already; try again shortly"));
}

bool Dispatcher::enqueue(Lane lane, const std::shared_ptr<Job>& job, const Answer& answer) {
  const auto work = [this, job, answer] { run(*job, answer); };
  if (lane == Lane::kTrack && job->tracks) return TrackLine::post(job->tracks, compute_, work);
  return (lane == Lane::kWrite ? writes_ : compute_)
      .post(job->connection, work, [this, job, answer] { turn_away(*job, answer); });
}

void Dispatcher::run(Job& job, const Answer& answer) {
  if (!job.claim()) return;
  v1::Envelope reply;
  try {
    reply = work(job);
  } catch (const std::exception& error) {  // the handler throws nothing: the log, or no memory
    reply = error_envelope(job.request.request_id(),
                           ErrorCode::kInternal,
                           std::string("an error of the server itself: ") + error.what());
  }
  answer(std::move(reply));
}

v1::Envelope Dispatcher::work(Job& job) {
  ++counters_.requests_total;
  ++counters_.in_flight;
  const Job::Clock::time_point started = Job::Clock::now();
  RunContext context;
  context.stop = job.stop.get_token();
  context.deadline = job.deadline;
  context.progress = job.progress;
  context.threads = threads_for(lane_of(job.request));
  v1::Envelope reply =
      handler_.handle(job.request, context, job.tracks ? &job.tracks->tracks() : nullptr);
  --counters_.in_flight;
  log_outcome(job, reply, started);
  return reply;
}

v1::Envelope Dispatcher::refuse(const Job& job, ErrorCode code, const std::string& message) {
  ++counters_.requests_total;
  v1::Envelope reply = error_envelope(job.request.request_id(), code, message);
  log_outcome(job, reply, Job::Clock::now());
  return reply;
}

// A lone query gets the whole machine, many share it; a write leaves half of it to the queries.
int Dispatcher::threads_for(Lane lane) const {
  if (lane == Lane::kWrite) return std::max(1, threads_ / 2);
  const auto running = static_cast<int>(std::max<std::size_t>(compute_.running(), 1));
  return std::max(1, threads_ / running);
}

void Dispatcher::log_outcome(const Job& job,
                             const v1::Envelope& reply,
                             Job::Clock::time_point started) {
  if (reply.has_error()) ++counters_.errors_total;
  if (!log_.wants(LogLevel::kInfo)) return;
  std::vector<LogField> fields = {
      {"connection", job.connection},
      {"request", job.request.request_id()},
      {"wait_ms", milliseconds(started - job.arrived)},
      {"total_ms", milliseconds(Job::Clock::now() - job.arrived)},
  };
  if (reply.has_error()) {
    fields.push_back(
        {"error", std::string(error_code_name(static_cast<ErrorCode>(reply.error().code())))});
    fields.push_back({"reason", reply.error().message()});
  } else if (reply.has_query_result()) {
    add_query_fields(reply.query_result(), fields);
  } else if (reply.has_recognize_result()) {
    add_recognize_fields(reply.recognize_result(), fields);
  } else if (reply.has_track_frame_result()) {
    add_track_fields(reply.track_frame_result(), fields);
  }
  log_.write(LogLevel::kInfo, request_name(job.request), fields);
}

}  // namespace landmarkdb
