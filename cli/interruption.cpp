// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Ctrl-C, the terminal's end and `kill`: what they do to the work, and the bar that shows how far
// it is.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "console.h"

namespace lamina::cli {
namespace {

constexpr int exit_code_interrupted = 130;
constexpr std::string_view erase_line = "\r\033[K";

// Read and written by a signal's handler.
std::atomic<bool> interrupted{false}, has_something_to_keep{false}, is_at_rest{false};
static_assert(std::atomic<bool>::is_always_lock_free);
volatile sig_atomic_t is_terminal = 0;  // standard error

void write_error(std::string_view text) {  // what a handler may call
  [[maybe_unused]] const ssize_t ignored = write(STDERR_FILENO, text.data(), text.size());
}

void on_signal(int) {
  const int before = errno;
  if (is_terminal) write_error(erase_line);
  if (is_at_rest) _exit(exit_code_interrupted);
  if (!has_something_to_keep) {
    write_error("lamina: interrupted: there was no result yet\n");
    _exit(exit_code_interrupted);
  }
  write_error("lamina: stopping, to keep what there is; once more ends at once, and loses it\n");
  interrupted = true;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) signal(number, SIG_DFL);
  errno = before;
}

/// Shown and kept up to date by a thread of its own, whether or not the work reports.
class Bar {
 public:
  Bar(std::string label, Keeps keeps) : label_(std::move(label)), keeps_(keeps) {
    is_at_rest = false;
    if (is_terminal) painter_ = std::jthread([this](const std::stop_token& end) { paint(end); });
  }

  bool operator()(double finished) {
    if (keeps_ == Keeps::what_there_is && finished > 0.0) has_something_to_keep = true;
    finished_ = finished;
    return !interrupted;
  }

 private:
  void paint(const std::stop_token& end) {
    using namespace std::chrono_literals;
    const auto start = std::chrono::steady_clock::now();
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any until_end;
    const auto is_over_after = [&](std::chrono::milliseconds time) {
      return until_end.wait_for(lock, end, time, [&] { return end.stop_requested(); });
    };
    if (is_over_after(1s)) return;
    do {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      write_error(line(finished_, elapsed.count()));
    } while (!is_over_after(100ms));
    write_error(erase_line);
  }

  [[nodiscard]] std::string line(double finished, double elapsed) const {
    if (finished <= 0.0) return fmt::format("\r{}: {:.0f} s so far\033[K", label_, elapsed);
    constexpr int width = 32;
    const int filled = static_cast<int>(finished * width);
    return fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f} %, {:.0f} s left\033[K", label_, "", filled,
                       "", width - filled, 100.0 * finished, elapsed * (1.0 - finished) / finished);
  }

  std::string label_;
  Keeps keeps_;
  std::atomic<double> finished_ = 0.0;
  std::jthread painter_;  // last: it reads the others
};

}  // namespace

Progress make_progress(std::string label, Keeps keeps) {
  return [bar = std::make_shared<Bar>(std::move(label), keeps)](double finished) {
    return (*bar)(finished);
  };
}

void rest_between_works() {
  has_something_to_keep = false;
  is_at_rest = true;
}

bool was_interrupted() { return interrupted; }

void watch_for_signals() {
  is_terminal = isatty(STDERR_FILENO);
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&action.sa_mask, number);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // else as nohup wants
  signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is then one that cannot be written
}

}  // namespace lamina::cli
