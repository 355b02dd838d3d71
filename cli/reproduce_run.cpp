// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "reproduce_run.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <string_view>
#include <thread>

#include "lamina/base/core/error.h"
#include "lamina/base/io/file_bytes.h"

namespace lamina::cli {
namespace {

constexpr const char* log_name = "log.txt";
constexpr const char* result_name = "result.json";

/// In the child, where only calls that a signal's handler may make are allowed.
[[noreturn]] void become(char* const* arguments, char* const* environment, const char* folder,
                         pid_t parent) {
  constexpr int failed_to_start = 127;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent || chdir(folder) != 0) _exit(failed_to_start);
  const int log = open(log_name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (log < 0 || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 ||
      dup2(nothing, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0)
    _exit(failed_to_start);
  execve("/proc/self/exe", arguments, environment);
  _exit(failed_to_start);
}

std::string last_line(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

}  // namespace

std::string run_this_program(const std::vector<std::string>& arguments,
                             const std::filesystem::path& folder, const Progress& progress) {
  std::vector<std::string> all = {"lamina"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--json", result_name});
  std::vector<char*> pointers;
  for (std::string& argument : all) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  std::filesystem::remove(folder / result_name);
  std::filesystem::remove(folder / log_name);

  // An item may be a stranger's: whatever its commands name, they write to its folder.
  std::vector<std::string> variables = {"LAMINA_WRITE_FOLDER=" + folder.string()};
  for (char** variable = environ; *variable; ++variable)
    if (!std::string_view(*variable).starts_with("LAMINA_WRITE_FOLDER="))
      variables.emplace_back(*variable);
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw Error("lamina cannot be started: no more processes");
  if (child == 0) become(pointers.data(), environment.data(), folder.c_str(), parent);
  int status = 0;
  bool was_asked_to_stop = false;
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) break;
    if (!was_asked_to_stop && !report_progress(progress, 0.0)) {
      was_asked_to_stop = true;
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (was_asked_to_stop || !report_progress(progress, 0.0)) throw Interrupted();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string command;
    for (const std::string& argument : arguments) command += ' ' + argument;
    throw InvalidInput("lamina" + command + ": " + last_line(read_file_bytes(folder / log_name)));
  }
  return read_file_bytes(folder / result_name);
}

}  // namespace lamina::cli
