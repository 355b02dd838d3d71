// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>

#include "lamina/base/core/error.h"

// Sizes that come from outside (the counts of a file, the grid that a user asks for) are multiplied
// and added here, so that none of them wraps around to a small one.

namespace lamina {

namespace size_detail {
[[noreturn]] inline void refuse(std::string_view what, std::initializer_list<std::size_t> parts,
                                std::string_view sign) {
  std::string text = std::string(what) + " is too large: ";
  for (const std::size_t* part = parts.begin(); part != parts.end(); ++part)
    text += (part == parts.begin() ? "" : std::string(sign)) + std::to_string(*part);
  throw InvalidInput(text + " is more than this machine can count");
}
}  // namespace size_detail

/// The product of sizes; 1 of none, 0 if one is 0.
/// @param what  is too large otherwise, as messages call it: "the grid of tally r-z".
/// @throws InvalidInput naming `what` and the factors.
[[nodiscard]] inline std::size_t checked_product(std::string_view what,
                                                 std::initializer_list<std::size_t> factors) {
  std::size_t product = 1;
  bool is_too_large = false;
  for (const std::size_t factor : factors) {
    if (factor == 0) return 0;
    is_too_large = is_too_large || product > std::numeric_limits<std::size_t>::max() / factor;
    if (!is_too_large) product *= factor;
  }
  if (is_too_large) size_detail::refuse(what, factors, " x ");
  return product;
}

/// The sum of sizes; 0 of none. @throws InvalidInput naming `what` and the terms.
[[nodiscard]] inline std::size_t checked_sum(std::string_view what,
                                             std::initializer_list<std::size_t> terms) {
  std::size_t sum = 0;
  for (const std::size_t term : terms) {
    if (term > std::numeric_limits<std::size_t>::max() - sum)
      size_detail::refuse(what, terms, " + ");
    sum += term;
  }
  return sum;
}

}  // namespace lamina
