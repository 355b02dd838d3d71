// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "lamina/base/core/error.h"

namespace lamina::cli {
namespace {

constexpr int not_found = 127, not_started = 126;  // exit codes of shells

/// Two ends of a pipe.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw Error(std::string("no more pipes: ") + std::strerror(errno));
  }
  ~Pipe() {
    for (int& end : ends_) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int from() const { return ends_[0]; }
  [[nodiscard]] int to() const { return ends_[1]; }
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
  void close_to() { close(ends_[1]); }

 private:
  std::array<int, 2> ends_ = {-1, -1};
};

/// In the child, where only calls that a signal's handler may make are allowed, and execvp.
[[noreturn]] void become(char* const* arguments, const char* folder, const Pipe& output,
                         const Pipe& errors, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (getppid() != parent || chdir(folder) != 0 || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 ||
      dup2(output.to(), STDOUT_FILENO) < 0 || dup2(errors.to(), STDERR_FILENO) < 0)
    _exit(not_started);
  execvp(arguments[0], arguments);
  _exit(errno == ENOENT ? not_found : not_started);
}

/// Reads both until their writers are gone.
void read_all(const Pipe& output, const Pipe& errors, ProgramRun& run) {
  std::array<pollfd, 2> open_ends = {pollfd{output.from(), POLLIN, 0},
                                     pollfd{errors.from(), POLLIN, 0}};
  std::array<char, 4096> bytes{};
  while (open_ends[0].fd >= 0 || open_ends[1].fd >= 0) {
    if (poll(open_ends.data(), open_ends.size(), -1) < 0 && errno != EINTR) return;
    for (std::size_t i = 0; i < open_ends.size(); ++i) {
      if (open_ends[i].fd < 0 || open_ends[i].revents == 0) continue;
      const ssize_t count = read(open_ends[i].fd, bytes.data(), bytes.size());
      if (count > 0)
        (i == 0 ? run.output : run.errors).append(bytes.data(), static_cast<std::size_t>(count));
      else if (count == 0 || errno != EINTR)
        open_ends[i].fd = -1;
    }
  }
}

}  // namespace

std::optional<ProgramRun> run_program(const std::vector<std::string>& words,
                                      const std::string& folder) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  Pipe output, errors;
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw Error(words[0] + " cannot be started: no more processes");
  if (child == 0) become(arguments.data(), folder.c_str(), output, errors, parent);
  output.close_to();
  errors.close_to();
  ProgramRun run;
  read_all(output, errors, run);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (run.exit_code == not_found && run.output.empty() && run.errors.empty()) return std::nullopt;
  return run;
}

std::string this_program() {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? "lamina" : file.string();
}

}  // namespace lamina::cli
