// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "lamina/core/error.h"
#include "lamina/core/memory_budget.h"
#include "lamina/core/number_text.h"

namespace lamina {

/// The number that a word of a mesh file spells, which may be infinite or NaN; absent if it spells
/// none. Too large a number is infinite, too small a one 0.
[[nodiscard]] inline std::optional<double> spelled_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || code == std::errc::invalid_argument) return std::nullopt;
  if (code == std::errc::result_out_of_range) return rounded_number(std::string(word));
  return value;
}

/// IEC 61966-2-1, for colors of vertices.
[[nodiscard]] inline float srgb_to_linear(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

/// Takes what a face or vertex adds to vectors that grow as the file is read: they may have room
/// for as much again, and for the faces and parts that the corners form.
inline void take_growing(MemoryBudget& memory, std::size_t bytes, std::string_view file) {
  constexpr std::size_t for_faces = 16;
  const std::size_t grown = 2 * (bytes + for_faces);
  if (grown > memory.left)
    throw FileError(std::string(file) +
                    ": its faces and vertices would take more memory than is left of the budget "
                    "(--memory-budget)");
  memory.left -= grown;
}

}  // namespace lamina
