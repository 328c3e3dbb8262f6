#include "tests/integration/programs.hpp"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace landmarkdb::testing {
namespace {

using namespace std::chrono_literals;

constexpr auto kPoll = 5ms;
constexpr auto kHealthPoll = 50ms;

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string path_of(const std::string& program) {
  const char* folder = std::getenv("LANDMARKDB_BIN");
  if (folder == nullptr) throw std::runtime_error("LANDMARKDB_BIN names no folder of programs");
  const std::string path = (std::filesystem::path(folder) / program).string();
  if (!std::filesystem::exists(path)) throw std::runtime_error(path + " is not built");
  return path;
}

std::vector<std::string> server_arguments(const std::string& db,
                                          const std::vector<std::string>& more,
                                          const std::string& unix_path) {
  std::vector<std::string> arguments = {"--db", db, "--listen"};
  if (unix_path.empty()) {
    arguments.emplace_back("127.0.0.1:0");
  } else {
    arguments.insert(arguments.end(), {"none", "--unix", unix_path});
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// In the child, between fork and exec: system calls only.
void redirect(const char* path, int flags, int descriptor) {
  const int file = ::open(path, flags, 0600);
  if (file < 0 || ::dup2(file, descriptor) < 0) ::_exit(127);
}

// What stands behind the first `mark` in the text, up to the line's end; empty without a full line.
std::string behind(const std::string& text, const std::string& mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return {};
  const std::size_t end = text.find('\n', at);
  if (end == std::string::npos) return {};
  return text.substr(at + mark.size(), end - at - mark.size());
}

}  // namespace

nlohmann::json Outcome::json() const { return nlohmann::json::parse(out); }

Running::Running(const std::string& program, const std::vector<std::string>& arguments) {
  std::string path = path_of(program);
  std::vector<std::string> words = arguments;
  std::vector<char*> argv = {path.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const std::string out = folder_ / "out";
  const std::string err = folder_ / "err";
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("cannot start " + path);
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that is killed leaves no server behind
    redirect("/dev/null", O_RDONLY, STDIN_FILENO);
    redirect(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    redirect(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
    ::execv(path.c_str(), argv.data());
    ::_exit(127);
  }
}

Running::~Running() {
  if (ended()) return;
  signal(SIGKILL);
  ::waitpid(pid_, &raw_status_, 0);
}

void Running::signal(int number) const {
  if (!ended_) ::kill(pid_, number);
}

bool Running::ended() {
  if (!ended_) ended_ = ::waitpid(pid_, &raw_status_, WNOHANG) == pid_;
  return ended_;
}

Outcome Running::wait(std::chrono::seconds timeout) {
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (!ended()) {
    if (std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("still running; so far: " + err_so_far());
    }
    std::this_thread::sleep_for(kPoll);
  }
  const int status =
      WIFEXITED(raw_status_) ? WEXITSTATUS(raw_status_) : 128 + WTERMSIG(raw_status_);
  return {.status = status, .out = text_of(folder_ / "out"), .err = text_of(folder_ / "err")};
}

std::string Running::err_so_far() const { return text_of(folder_ / "err"); }

Outcome run(const std::string& program, const std::vector<std::string>& arguments) {
  return Running(program, arguments).wait();
}

ServerProcess::ServerProcess(const std::string& db,
                             const std::vector<std::string>& arguments,
                             const std::string& unix_path)
    : process_("landmarkdb-server", server_arguments(db, arguments, unix_path)) {
  const auto give_up = std::chrono::steady_clock::now() + 120s;
  for (bool ready = false; !ready; std::this_thread::sleep_for(kHealthPoll)) {
    if (process_.ended() || std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("the server does not get ready: " + process_.err_so_far());
    }
    address_ = behind(process_.err_so_far(), "listening on ");
    // Without the token of a protected server nobody may ask for its health; that is an answer too.
    const int status = address_.empty() ? 8 : client({"health"}).status;
    ready = status == 0 || status == 9;
  }
}

Outcome ServerProcess::client(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {"--server", address_});
  return run("landmarkdb", arguments);
}

Outcome ServerProcess::stop() {
  process_.signal(SIGTERM);
  return process_.wait(std::chrono::seconds(30));
}

}  // namespace landmarkdb::testing
