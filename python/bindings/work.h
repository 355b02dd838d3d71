// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lamina/base/core/progress.h"

namespace lamina::python {

namespace py = pybind11;

/// Long work as Python calls it: without Python's lock, so that other threads go on; heard by
/// Ctrl-C, if it is called from the main thread; telling a callback how far it is.
class Work {
 public:
  /// @param callback  None, or what is called with the finished fraction some ten times a second,
  ///                  from any thread; it ends the work early by returning False or raising.
  explicit Work(const py::object& callback);
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  ~Work();

  /// Result of `work(progress)`. @throws what it throws; what the callback has raised; and
  /// Interrupted after Ctrl-C.
  template <class F>
  auto run(const F& work) {
    auto result = run_partly(work);
    if (was_interrupted()) throw Interrupted();
    return result;
  }

  /// Result of work that hands over what it has when it is stopped: whoever calls asks
  /// was_interrupted().
  template <class F>
  auto run_partly(const F& work) {
    const Restore at_the_end{*this};
    try {
      auto result = [&] {
        const py::gil_scoped_release unlocked;
        return work(progress());
      }();
      raise_what_was_raised();
      restore();
      return result;
    } catch (const Interrupted&) {
      raise_what_was_raised();
      throw;
    }
  }

  /// Whether Ctrl-C, or the callback, has ended it early.
  [[nodiscard]] bool was_interrupted() const;

 private:
  struct State;
  struct Restore {
    Work& work;
    ~Restore() { work.restore(); }
  };
  [[nodiscard]] Progress progress() const;
  void restore();
  void raise_what_was_raised() const;

  std::unique_ptr<State> state_;
};

/// `body(i)` for each i in [0, count), on all threads, without a callback: heard by Ctrl-C.
/// @throws Interrupted after it
void run_in_parts(std::size_t count, const std::function<void(std::size_t)>& body);

/// `solve(i)` for each i in [0, count), on all threads. Where it is stopped, what is not done by
/// then is absent.
/// @throws Interrupted if nothing is done by then
template <class Result, class Solve>
[[nodiscard]] std::vector<std::optional<Result>> solve_each(std::size_t count,
                                                            const Progress& progress,
                                                            const Solve& solve) {
  std::vector<std::optional<Result>> results(count);
  try {
    parallel_for(
        count, [&](std::size_t i) { results[i] = solve(i); }, progress);
  } catch (const Interrupted&) {
    const auto is_done = [](const std::optional<Result>& result) { return result.has_value(); };
    if (std::ranges::none_of(results, is_done)) throw;
  }
  return results;
}

void bind_work(py::module_& module);

}  // namespace lamina::python
