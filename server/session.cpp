#include "server/session.hpp"

#include <algorithm>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>

#include "server/hello.hpp"

namespace landmarkdb {

namespace {

std::string encode(const v1::Envelope& envelope) {
  const std::size_t bytes = envelope.ByteSizeLong();
  std::string frame(kFrameHeaderBytes + bytes, '\0');
  write_frame_header(bytes, frame.data());
  envelope.SerializeWithCachedSizesToArray(
      reinterpret_cast<std::uint8_t*>(frame.data() + kFrameHeaderBytes));
  return frame;
}

}  // namespace

Session::Session(Socket socket,
                 std::uint64_t id,
                 std::string peer,
                 SessionServices& services,
                 SessionEvents events)
    : Connection(std::move(socket), services.options.connection, services.budget),
      id_(id),
      peer_(std::move(peer)),
      services_(services),
      events_(std::move(events)),
      tracks_(std::make_shared<TrackLine>(services.counters, id)) {}

void Session::start() {
  boost::asio::dispatch(
      executor(), bound([this] {
        services_.log.write(LogLevel::kDebug, "connected", {{"connection", id_}, {"peer", peer_}});
        start_reading();
      }));
}

void Session::make_room() {
  boost::asio::dispatch(executor(), bound([this] {
                          if (!greeted_) cut("it had not said Hello, and others came");
                        }));
}

void Session::go_away(const std::string& why) {
  boost::asio::dispatch(executor(), bound([this, why] {
                          if (!open() || leaving_) return;
                          leaving_ = true;
                          v1::Envelope envelope;
                          envelope.mutable_go_away()->set_reason(why);
                          send(envelope);
                          close_if_done();
                        }));
}

void Session::cancel_requests() {
  boost::asio::dispatch(executor(), bound([this] {
                          std::vector<std::uint64_t> ids;
                          for (const auto& entry : requests_) ids.push_back(entry.first);
                          for (const std::uint64_t id : ids) cancel(id);
                        }));
}

void Session::close_now() {
  boost::asio::dispatch(executor(), bound([this] { cut("the server is stopping"); }));
}

void Session::on_frame(std::string_view payload, MemoryBudget::Lease memory) {
  v1::Envelope envelope;
  if (!envelope.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    on_broken(ErrorCode::kInvalidArgument,
              "the " + std::to_string(payload.size()) + " bytes of the message are no Envelope");
    close_after_sending();
    return;
  }
  if (!greeted_ || envelope.has_hello()) {
    hello(envelope);
  } else if (envelope.has_cancel()) {
    cancel(envelope.request_id());
  } else if (!envelope.has_pong()) {
    const std::uint64_t request_id = envelope.request_id();
    try {
      submit(std::move(envelope), std::move(memory));
    } catch (const std::exception& error) {
      fail(request_id, error);
    }
  }
}

void Session::hello(const v1::Envelope& envelope) {
  if (greeted_) {
    send_error(envelope.request_id(), ErrorCode::kFailedPrecondition, "Hello came already");
    return;
  }
  v1::Envelope answer = answer_hello(envelope, services_.options, services_.state);
  if (answer.has_error()) {
    refuse_hello(answer);
    return;
  }
  if (!take_place()) {
    ++services_.counters.rejected_total;
    refuse_hello(error_envelope(envelope.request_id(),
                                ErrorCode::kResourceExhausted,
                                "all " + std::to_string(services_.options.max_connections) +
                                    " connections (--max-connections) are taken; try again later"));
    return;
  }
  if (events_.on_greeted) events_.on_greeted();
  open_up(services_.options.max_message_bytes);
  services_.log.write(
      LogLevel::kDebug, "hello", {{"connection", id_}, {"client", envelope.hello().client()}});
  send(answer);
}

bool Session::take_place() {
  std::size_t taken = services_.clients;
  do {
    if (taken >= services_.options.max_connections) return false;
  } while (!services_.clients.compare_exchange_weak(taken, taken + 1));
  greeted_ = true;
  return true;
}

void Session::refuse_hello(const v1::Envelope& answer) {
  services_.log.write(LogLevel::kWarning,
                      "refused",
                      {{"connection", id_}, {"peer", peer_}, {"reason", answer.error().message()}});
  send(answer);
  close_after_sending();
}

void Session::submit(v1::Envelope envelope, MemoryBudget::Lease memory) {
  const std::uint64_t request_id = envelope.request_id();
  if (leaving_) {
    send_error(request_id, ErrorCode::kUnavailable, "the server is stopping");
    return;
  }
  if (request_id == 0) {
    send_error(0, ErrorCode::kInvalidArgument, "a request needs a number above 0", "request_id");
    return;
  }
  if (requests_.contains(request_id)) {
    // Two answers with one number cannot be told apart, so this client cannot be served on.
    send_error(0,
               ErrorCode::kInvalidArgument,
               "request " + std::to_string(request_id) + " is still open, its number is taken",
               "request_id");
    close_after_sending();
    return;
  }
  if (requests_.size() >= services_.options.connection.max_open_requests) {
    send_error(request_id,
               ErrorCode::kResourceExhausted,
               std::to_string(requests_.size()) +
                   " requests are open on this connection, no more are taken");
    return;
  }

  auto job = std::make_shared<Job>();
  job->request = std::move(envelope);
  job->connection = id_;
  job->tracks = tracks_;
  job->memory = std::move(memory);
  OpenRequest& open = requests_[request_id];
  open.job = job;
  set_deadline(open);
  // Throttled on the working thread, which is the only one to call this. Shared by the copies that
  // are made of the callback.
  job->progress =
      [this,
       weak = weak_from_this(),
       request_id,
       interval = services_.options.connection.progress_interval,
       last = std::make_shared<Clock::time_point>(job->arrived)](const Progress& progress) {
        const Clock::time_point now = Clock::now();
        if (now - *last < interval) return;
        *last = now;
        const auto alive = weak.lock();
        if (!alive) return;
        boost::asio::post(executor(),
                          bound([this, request_id, stage = std::string(progress.stage), progress] {
                            report(request_id, {stage, progress.done, progress.total});
                          }));
      };
  services_.dispatcher.submit(job, [this, alive = self(), request_id](v1::Envelope answer) {
    boost::asio::dispatch(executor(), bound([this, request_id, answer = std::move(answer)] {
                            finish(request_id, answer);
                          }));
  });
}

void Session::fail(std::uint64_t request_id, const std::exception& error) {
  const auto found = requests_.find(request_id);
  // Claimed: the dispatcher has it, and will answer.
  if (found != requests_.end() && !found->second.job->claim()) return;
  requests_.erase(request_id);
  send_error(request_id,
             ErrorCode::kInternal,
             std::string("an error of the server itself: ") + error.what());
}

// Queries end in time whatever the client asks for; changes take the time they need unless the
// client sets a limit.
void Session::set_deadline(OpenRequest& open) {
  Job& job = *open.job;
  std::chrono::milliseconds limit(job.request.timeout_ms());
  const Lane lane = lane_of(job.request);
  if (lane == Lane::kCompute || lane == Lane::kTrack) {
    const std::chrono::milliseconds own = services_.options.deadline;
    limit = limit.count() == 0 ? own : std::min(limit, own);
  }
  if (limit.count() == 0) return;
  job.deadline = job.arrived + limit;
  open.deadline_timer = std::make_unique<boost::asio::steady_timer>(executor(), *job.deadline);
  open.deadline_timer->async_wait(
      bound([this, id = job.request.request_id()](const auto& cancelled) {
        if (cancelled) return;
        answer_if_waiting(
            id, ErrorCode::kDeadlineExceeded, "the deadline passed while the request was waiting");
      }));
}

void Session::cancel(std::uint64_t request_id) {
  const auto found = requests_.find(request_id);
  if (found == requests_.end()) return;  // answered already
  found->second.job->stop.request_stop();
  answer_if_waiting(request_id, ErrorCode::kCancelled, "stopped on request while it was waiting");
}

void Session::answer_if_waiting(std::uint64_t request_id,
                                ErrorCode code,
                                const std::string& message) {
  const auto found = requests_.find(request_id);
  if (found == requests_.end() || !found->second.job->claim()) return;
  finish(request_id, services_.dispatcher.refuse(*found->second.job, code, message));
}

void Session::report(std::uint64_t request_id, const Progress& progress) {
  // A reader that is behind needs answers, not progress.
  if (!open() || sending() || !requests_.contains(request_id)) return;
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  v1::Progress& message = *envelope.mutable_progress();
  message.set_stage(std::string(progress.stage));
  message.set_done(progress.done);
  message.set_total(progress.total);
  send(envelope);
}

void Session::finish(std::uint64_t request_id, const v1::Envelope& answer) {
  if (requests_.erase(request_id) == 0 || !open()) return;
  send(answer);
  rearm_timer();
  close_if_done();
}

void Session::send(const v1::Envelope& envelope) { send_frame(encode(envelope)); }

void Session::send_error(std::uint64_t request_id,
                         ErrorCode code,
                         const std::string& message,
                         const std::string& field) {
  services_.log.write(LogLevel::kWarning,
                      "refused",
                      {{"connection", id_},
                       {"request", request_id},
                       {"error", std::string(error_code_name(code))},
                       {"reason", message}});
  send(error_envelope(request_id, code, message, field));
}

void Session::on_broken(ErrorCode code, const std::string& message) {
  send_error(0, code, message);
}

// Half-closed and closed look alike from here, and most who end their sending are gone.
void Session::on_input_end() {
  stop_requests();
  close_after_sending();
}

void Session::on_idle() { go_away("idle"); }

void Session::close_if_done() {
  if (leaving_ && requests_.empty()) close_after_sending();
}

void Session::stop_requests() {
  for (auto& entry : requests_) entry.second.job->stop.request_stop();
  requests_.clear();
}

void Session::on_closed(const std::string& why) {
  stop_requests();
  tracks_.reset();
  if (std::exchange(greeted_, false)) --services_.clients;
  if (events_.on_closed) std::exchange(events_.on_closed, nullptr)();
  std::vector<LogField> fields = {{"connection", id_}};
  if (!why.empty()) fields.push_back({"reason", why});
  services_.log.write(why.empty() ? LogLevel::kDebug : LogLevel::kInfo, "closed", fields);
}

}  // namespace landmarkdb
