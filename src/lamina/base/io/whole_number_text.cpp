// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/whole_number_text.h"

#include <bit>

namespace lamina {

std::string whole_number_text(std::uint64_t value) {
  constexpr std::uint64_t readable = 1'000'000;
  if (value < readable) return std::to_string(value);
  std::uint64_t digits = value;
  int zeros = 0;
  for (; digits % 10 == 0; digits /= 10) ++zeros;
  if (digits < 10) return std::to_string(digits) + "e" + std::to_string(zeros);
  if (std::has_single_bit(value)) return "2^" + std::to_string(std::countr_zero(value));
  if (std::has_single_bit(value + 1) || value + 1 == 0)
    return "2^" + std::to_string(std::countr_one(value)) + " - 1";
  return std::to_string(value);
}

std::string whole_number_text(std::int64_t value) {
  if (value >= 0) return whole_number_text(static_cast<std::uint64_t>(value));
  return "-" + whole_number_text(std::uint64_t{0} - static_cast<std::uint64_t>(value));
}

}  // namespace lamina
