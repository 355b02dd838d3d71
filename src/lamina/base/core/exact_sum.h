// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace lamina {

/// A sum without rounding: it does not depend on the order in which it is added up, nor on how it
/// is split into sums that are added later. It is a whole number of steps of 2^-FractionBits, in
/// two's complement, lowest word first.
///
/// Terms are rounded to whole steps, and cut to [-limit, limit], so that 2^24 of them fit. What is
/// no number counts as the limit, to be seen.
template <int Words, int FractionBits>
class ExactSum {
 public:
  static constexpr int limit_exponent = 64 * Words - 25 - FractionBits;
  static_assert(Words >= 1 && limit_exponent >= 0);

  void add(double term) {
    constexpr double limit = power_of_two(limit_exponent);
    if (!(std::abs(term) < limit)) term = std::signbit(term) ? -limit : limit;
    const auto bits = std::bit_cast<std::uint64_t>(term);
    const int exponent = static_cast<int>((bits >> 52) & 0x7ff);
    if (exponent == 0) return;  // 0, or far below a step
    std::uint64_t digits = (bits & 0xf'ffff'ffff'ffff) | (std::uint64_t{1} << 52);
    int shift = exponent - 1075 + FractionBits;  // of the digits, in steps
    if (shift < -53) return;
    if (shift < 0) {
      digits = (digits + (std::uint64_t{1} << (-shift - 1))) >> -shift;
      shift = 0;
    }
    ExactSum addend;
    const auto place = static_cast<std::size_t>(shift / 64);
    const int up = shift % 64;
    addend.words_[place] = digits << up;
    if (up > 0 && place + 1 < Words) addend.words_[place + 1] = digits >> (64 - up);
    if (bits >> 63) addend.negate();
    add(addend);
  }

  void add(const ExactSum& other) {
    std::uint64_t carry = 0;
    for (int i = 0; i < Words; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const std::uint64_t with_carry = other.words_[at] + carry;
      carry = with_carry < carry ? 1 : 0;
      words_[at] += with_carry;
      carry += words_[at] < with_carry ? 1 : 0;
    }
  }

  /// Value of the sum, rounded, within some 10^-16 of it.
  [[nodiscard]] double value() const {
    ExactSum magnitude = *this;
    const bool is_negative = words_.back() >> 63;
    if (is_negative) magnitude.negate();
    double steps = 0.0;
    for (auto word = magnitude.words_.rbegin(); word != magnitude.words_.rend(); ++word)
      steps = steps * 0x1p64 + static_cast<double>(*word);
    constexpr double step = 1.0 / power_of_two(FractionBits);
    return (is_negative ? -steps : steps) * step;
  }

  friend bool operator==(const ExactSum&, const ExactSum&) = default;

 private:
  static constexpr double power_of_two(int exponent) {
    double power = 1.0;
    for (int i = 0; i < exponent; ++i) power *= 2.0;
    return power;
  }

  void negate() {
    std::uint64_t carry = 1;
    for (std::uint64_t& word : words_) {
      word = ~word + carry;
      carry = carry != 0 && word == 0 ? 1 : 0;
    }
  }

  std::array<std::uint64_t, Words> words_{};
};

}  // namespace lamina
