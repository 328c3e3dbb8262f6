#include "bench/load/server_process.hpp"

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/client.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPoll{2};  // a five-hundredth of the second it may take
constexpr std::chrono::minutes kPatience{10};

std::string beside_us(const std::string& program) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / program).string();
}

// Whether queries are answered; connects first, which fails until the server listens.
bool is_ready(const std::string& address, std::optional<client::Client>& client) {
  try {
    if (!client) client.emplace(client::ConnectOptions{.server = address}, RunContext{});
    return client->health({}).ready;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kUnavailable) throw;
    client.reset();
    return false;
  }
}

}  // namespace

ServerProcess::ServerProcess(const std::string& db, int threads)
    : address_("unix:" + folder_.file("socket")) {
  const std::string count = std::to_string(threads);
  const std::string socket = folder_.file("socket");
  const std::string program = beside_us("landmarkdb-server");
  const std::array<const char*, 13> words = {program.c_str(),
                                             "--db",
                                             db.c_str(),
                                             "--listen",
                                             "none",
                                             "--unix",
                                             socket.c_str(),
                                             "--threads",
                                             count.c_str(),
                                             "--read-only",
                                             "--log-level",
                                             "off",
                                             nullptr};
  const auto start = Clock::now();
  pid_ = ::fork();
  if (pid_ < 0) throw Error(ErrorCode::kUnavailable, "cannot start " + program);
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a bench that is killed leaves no server behind
    ::execv(program.c_str(), const_cast<char* const*>(words.data()));
    ::_exit(127);
  }
  wait_until_ready(start);
}

void ServerProcess::wait_until_ready(Clock::time_point start) {
  std::optional<client::Client> client;
  while (!is_ready(address_, client)) {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      throw Error(ErrorCode::kUnavailable, "landmarkdb-server ended before it was ready");
    }
    if (Clock::now() - start > kPatience) {
      throw Error(ErrorCode::kUnavailable, "landmarkdb-server does not get ready");
    }
    std::this_thread::sleep_for(kPoll);
  }
  seconds_until_ready_ = std::chrono::duration<double>(Clock::now() - start).count();
}

ServerProcess::~ServerProcess() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  int status = 0;
  ::waitpid(pid_, &status, 0);
}

std::uint64_t ServerProcess::peak_resident_bytes() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  }
  return 0;
}

}  // namespace landmarkdb::bench
