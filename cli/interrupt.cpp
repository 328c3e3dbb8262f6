#include "cli/interrupt.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

namespace landmarkdb::cli {
namespace {

constexpr char kSignalled = 's';
constexpr char kGoodbye = 'q';

// What the handler may touch: lock-free atomics and write(2).
std::atomic<int> write_end{-1};
std::atomic<bool> signalled{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

extern "C" void on_stop_signal(int signal) {
  const int saved_errno = errno;
  if (signalled.exchange(true)) {
    std::signal(signal, SIG_DFL);
    ::raise(signal);
  } else {
    const int descriptor = write_end.load();
    // Nothing can be done about a failure here; the second signal still kills.
    if (descriptor >= 0 && ::write(descriptor, &kSignalled, 1) < 0) errno = 0;
  }
  errno = saved_errno;
}

}  // namespace

struct Interrupt::State {
  std::stop_source source;
  int pipe[2] = {-1, -1};
  struct sigaction previous_int {};
  struct sigaction previous_term {};
  std::thread watcher;

  void watch() {
    char byte = 0;
    while (true) {
      const auto got = ::read(pipe[0], &byte, 1);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0 || byte == kGoodbye) return;
      source.request_stop();
    }
  }
};

Interrupt::Interrupt() : state_(std::make_unique<State>()) {
  if (::pipe2(state_->pipe, O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "pipe for signals");
  }
  signalled = false;
  write_end = state_->pipe[1];
  state_->watcher = std::thread([state = state_.get()] { state->watch(); });

  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, &state_->previous_int);
  ::sigaction(SIGTERM, &action, &state_->previous_term);
}

Interrupt::~Interrupt() {
  ::sigaction(SIGINT, &state_->previous_int, nullptr);
  ::sigaction(SIGTERM, &state_->previous_term, nullptr);
  write_end = -1;
  while (::write(state_->pipe[1], &kGoodbye, 1) < 0 && errno == EINTR) {
  }
  state_->watcher.join();
  ::close(state_->pipe[0]);
  ::close(state_->pipe[1]);
}

std::stop_token Interrupt::token() const { return state_->source.get_token(); }

}  // namespace landmarkdb::cli
