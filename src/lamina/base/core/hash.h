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

#include "lamina/base/core/random.h"

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
    std::uint64_t state = value_ ^ word;
    value_ = Random::splitmix(state);
  }
  std::uint64_t value_ = 0;
};

/// A number for a cell of a lattice in space, to keep cells in a table of a power of two slots.
[[nodiscard]] inline std::uint32_t hash_cell(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto word = [](std::int32_t i) { return static_cast<std::uint32_t>(i); };
  std::uint32_t h = word(x) * 0x8da6b343u ^ word(y) * 0xd8163841u ^ word(z) * 0xcb1ab31fu;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  return h ^ (h >> 13);
}

/// A key for a cell of a lattice in space, such as the index of a stream of random numbers.
[[nodiscard]] inline std::uint64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
         static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu ^
         static_cast<std::uint64_t>(z) * 0x165667b19e3779f9u;
}

}  // namespace lamina
