#include "tests/unit/indexer/run_program.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace landmarkdb::indexer::testing {
namespace {

constexpr unsigned kNobody = 65534;  // Debian's user and group without rights

struct Channel {
  int read_end = -1;
  int write_end = -1;
};

Channel make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe");
  return {ends[0], ends[1]};
}

Channel make_terminal() {
  Channel channel;
  if (::openpty(&channel.read_end, &channel.write_end, nullptr, nullptr, nullptr) != 0) {
    throw std::runtime_error("openpty");
  }
  ::fcntl(channel.read_end, F_SETFD, FD_CLOEXEC);
  return channel;
}

[[noreturn]] void become(const std::string& path,
                         const std::vector<std::string>& arguments,
                         const RunOptions& options,
                         int out,
                         int err) {
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (options.max_file_bytes) {
    const rlimit limit{*options.max_file_bytes, *options.max_file_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  constexpr int kCannotRun = 127;
  if (options.as_nobody && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(kCannotRun);
  std::vector<char*> argv;
  argv.push_back(const_cast<char*>(path.c_str()));
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  ::execv(path.c_str(), argv.data());
  ::_exit(kCannotRun);
}

// Appends what is there to `text`; false at the end. A terminal whose other side is gone says EIO.
bool drain(int descriptor, std::string& text) {
  std::array<char, 4096> bytes{};
  const auto got = ::read(descriptor, bytes.data(), bytes.size());
  if (got > 0) text.append(bytes.data(), static_cast<std::size_t>(got));
  return got > 0 || (got < 0 && errno == EINTR);
}

}  // namespace

bool has_terminals() {
  int ours = -1;
  int theirs = -1;
  if (::openpty(&ours, &theirs, nullptr, nullptr, nullptr) != 0) return false;
  ::close(ours);
  ::close(theirs);
  return true;
}

RunResult run_program(const std::string& name,
                      const std::vector<std::string>& arguments,
                      const RunOptions& options) {
  const char* folder = std::getenv("LANDMARKDB_BIN");
  if (folder == nullptr) throw std::runtime_error("LANDMARKDB_BIN is not set");
  const std::string path = std::string(folder) + '/' + name;
  const Channel out = make_pipe();
  const Channel err = options.signal_at.empty() ? make_pipe() : make_terminal();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) become(path, arguments, options, out.write_end, err.write_end);
  ::close(out.write_end);
  ::close(err.write_end);

  RunResult result;
  bool signalled = options.signal_at.empty();
  std::array<pollfd, 2> open = {pollfd{out.read_end, POLLIN, 0}, pollfd{err.read_end, POLLIN, 0}};
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    if (::poll(open.data(), open.size(), -1) < 0) continue;
    if (open[0].revents != 0 && !drain(open[0].fd, result.out)) open[0].fd = -1;
    if (open[1].revents != 0 && !drain(open[1].fd, result.err)) open[1].fd = -1;
    if (!signalled && result.err.find(options.signal_at) != std::string::npos) {
      ::kill(child, options.signal);
      signalled = true;
    }
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  ::close(out.read_end);
  ::close(err.read_end);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace landmarkdb::indexer::testing
