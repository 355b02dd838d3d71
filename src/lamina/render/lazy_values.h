// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lamina {

/// Values at points, each worked out by the first who asks for it, from any thread.
template <class Value>
class LazyValues {
 public:
  LazyValues() = default;
  explicit LazyValues(std::size_t count)
      : values_(count), states_(std::make_unique<std::atomic<std::uint8_t>[]>(count)) {}

  /// @param make  i to its value; the same whoever calls it
  template <class Make>
  [[nodiscard]] Value at(std::size_t i, const Make& make) {
    enum : std::uint8_t { unknown, in_work, known };
    if (states_[i].load(std::memory_order_acquire) == known) return values_[i];
    const Value value = make(i);
    std::uint8_t expected = unknown;
    if (states_[i].compare_exchange_strong(expected, in_work)) {
      values_[i] = value;
      states_[i].store(known, std::memory_order_release);
    }
    return value;
  }

 private:
  std::vector<Value> values_;
  std::unique_ptr<std::atomic<std::uint8_t>[]> states_;
};

}  // namespace lamina
