// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

namespace lamina {

/// Values at points, each computed when it is first asked for, from any thread.
template <class Value>
class LazyValues {
 public:
  LazyValues() = default;
  explicit LazyValues(std::size_t count) : cells_(std::make_unique<Cell[]>(count)) {}

  /// @param make  i to its value; the same whoever calls it
  template <class Make>
  [[nodiscard]] Value at(std::size_t i, const Make& make) {
    const Cell& cell = cells_[i];
    if (cell.state.load(std::memory_order_acquire) == known) return cell.value;
    return compute(i, make);
  }

 private:
  enum : std::uint8_t { unknown, in_work, known };
  struct Cell {  // side by side: one line of the cache
    Value value{};
    std::atomic<std::uint8_t> state{unknown};
  };
  template <class Make>
  [[gnu::noinline]] Value compute(std::size_t i, const Make& make) {
    Cell& cell = cells_[i];
    const Value value = make(i);
    std::uint8_t expected = unknown;
    if (cell.state.compare_exchange_strong(expected, in_work)) {
      cell.value = value;
      cell.state.store(known, std::memory_order_release);
    }
    return value;
  }
  std::unique_ptr<Cell[]> cells_;
};

/// The last values of a slow function that depends on nothing but its key, from any thread: for
/// what bands, variants and scenes of a process ask for again and again.
template <class Key, class Value>
class KeptValues {
 public:
  /// @param most  values that are kept; one more, and all are forgotten
  explicit KeptValues(std::size_t most) : most_(most) {}

  /// @param make  makes the value; two threads that ask at once both may
  template <class Make>
  [[nodiscard]] Value at(const Key& key, const Make& make) {
    {
      const std::scoped_lock lock(mutex_);
      if (const auto found = values_.find(key); found != values_.end()) return found->second;
    }
    Value value = make();
    const std::scoped_lock lock(mutex_);
    if (values_.size() >= most_) values_.clear();
    values_.emplace(key, value);
    return value;
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::map<Key, Value> values_;
};

}  // namespace lamina
