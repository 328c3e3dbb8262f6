#include "tests/integration/programs.hpp"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

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

// What stands behind the first `mark` in the text, up to the line's end; empty without a full line.
std::string behind(const std::string& text, const std::string& mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return {};
  const std::size_t end = text.find('\n', at);
  if (end == std::string::npos) return {};
  return text.substr(at + mark.size(), end - at - mark.size());
}

}  // namespace

TempFolder::TempFolder() {
  std::string path = (std::filesystem::temp_directory_path() / "landmarkdb_XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = path;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

nlohmann::json Outcome::json() const { return nlohmann::json::parse(out); }

Running::Running(const std::string& program, const std::vector<std::string>& arguments) {
  std::string path = path_of(program);
  std::vector<std::string> words = arguments;
  std::vector<char*> argv = {path.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (folder_ / "out").c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (folder_ / "err").c_str(), flags, 0600);
  const int rc = posix_spawn(&pid_, path.c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (rc != 0) throw std::runtime_error("cannot start " + path);
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
