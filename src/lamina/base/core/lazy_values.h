// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

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

}  // namespace lamina
