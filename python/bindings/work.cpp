// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "work.h"

#include <signal.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>

#include "lamina/base/core/parallel.h"

namespace lamina::python {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds between_calls{100};

// Of the one call that the main thread is in.
std::atomic<bool> has_heard_signal{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int) { has_heard_signal = true; }

/// Signals are for the main thread: only there does Python turn them into exceptions.
bool is_main_thread() {
  static const auto main =
      py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
  return PyThread_get_thread_ident() == main;
}

}  // namespace

struct Work::State {
  py::object callback;
  bool hears_signals = false;
  struct sigaction former = {};
  bool was_interrupted = false;

  std::mutex mutex;  // of what follows: any thread may report
  Clock::time_point last_call = Clock::now();
  std::exception_ptr raised;
  std::atomic<bool> is_stopped{false};

  void call(double finished) {
    const std::unique_lock lock(mutex, std::try_to_lock);
    if (!lock || is_stopped || Clock::now() - last_call < between_calls) return;
    const py::gil_scoped_acquire locked;
    try {
      const py::object answer = callback(finished);
      if (!answer.is_none() && !answer.cast<bool>()) is_stopped = true;
    } catch (py::error_already_set&) {
      raised = std::current_exception();
      is_stopped = true;
    }
    last_call = Clock::now();
  }
};

Work::Work(const py::object& callback) : state_(std::make_unique<State>()) {
  state_->callback = callback;
  if (!is_main_thread()) return;
  has_heard_signal = false;
  struct sigaction action = {};
  action.sa_handler = on_signal;
  state_->hears_signals = sigaction(SIGINT, &action, &state_->former) == 0;
  // What ignores Ctrl-C, as a background job does, goes on doing so.
  if (state_->hears_signals && state_->former.sa_handler == SIG_IGN) {
    sigaction(SIGINT, &state_->former, nullptr);
    state_->hears_signals = false;
  }
}

Work::~Work() { restore(); }

void Work::restore() {
  if (!state_->hears_signals) return;
  sigaction(SIGINT, &state_->former, nullptr);
  state_->hears_signals = false;
  state_->was_interrupted = has_heard_signal;
}

bool Work::was_interrupted() const { return state_->was_interrupted || state_->is_stopped; }

Progress Work::progress() const {
  return [state = state_.get()](double finished) {
    if (!state->callback.is_none()) state->call(finished);
    return !state->is_stopped && !(state->hears_signals && has_heard_signal);
  };
}

void Work::raise_what_was_raised() const {
  if (state_->raised) std::rethrow_exception(state_->raised);
}

void run_in_parts(std::size_t count, const std::function<void(std::size_t)>& body) {
  Work work{py::none()};
  const auto all = [&](const Progress& progress) {
    parallel_for(count, body, progress);
    return true;
  };
  (void)work.run(all);
}

void bind_work(py::module_& module) {
  module.def("set_thread_count", &set_thread_count, py::arg("threads"));
  module.def("thread_count", &thread_count);
}

}  // namespace lamina::python
