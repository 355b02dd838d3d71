// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lamina {

/// A number that follows from a row of values: a checksum, or a key to find things by.
///
/// Rows that differ in one word of 8 bytes have different numbers for certain, as each step is one
/// to one; others but for one case in 10^19. It does not stand up to someone who seeks such a case.
///
/// Source: the mixing step of SplitMix64 [Steele2014], with the next word put in before each.
class Hash {
 public:
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(T value) {
    if constexpr (std::is_floating_point_v<T>)
      if (value == T{0}) value = T{0};  // -0 is 0
    std::uint64_t word = 0;
    std::memcpy(&word, &value, sizeof value);
    add_word(word);
  }
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
  }
  void add_bytes(std::span<const std::byte> bytes) {
    add(bytes.size());
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
      add_word(word);
    }
  }
  void add_text(std::string_view text) { add_bytes(std::as_bytes(std::span(text))); }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  void add_word(std::uint64_t word) {
    value_ = (value_ ^ word) + 0x9e3779b97f4a7c15u;
    value_ = (value_ ^ (value_ >> 30)) * 0xbf58476d1ce4e5b9u;
    value_ = (value_ ^ (value_ >> 27)) * 0x94d049bb133111ebu;
    value_ ^= value_ >> 31;
  }
  std::uint64_t value_ = 0;
};

}  // namespace lamina
