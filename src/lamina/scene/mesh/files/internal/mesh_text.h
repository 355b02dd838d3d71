// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "lamina/base/core/error.h"
#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/number_text.h"

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

/// Text without the byte order mark that some editors put in front.
[[nodiscard]] inline std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

/// The character that ends lines: of old Macs a carriage return, with no line feed in the file.
[[nodiscard]] inline char end_of_lines(std::string_view text) {
  return text.find('\n') == std::string_view::npos ? '\r' : '\n';
}

/// IEC 61966-2-1, for colors of vertices.
[[nodiscard]] inline float srgb_to_linear(float value) {
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

/// The range of the colors of vertices in files that do not say it: [0, 1], or whole numbers in
/// [0, 255].
class VertexColorRange {
 public:
  void add(double value, int line) {
    are_whole_ = are_whole_ && value == std::floor(value);
    if (value > largest_) largest_ = value, line_ = line;
  }
  [[nodiscard]] bool is_bytes() const { return largest_ > slack && are_whole_ && largest_ <= 255; }
  [[nodiscard]] bool is_known() const { return largest_ <= slack || is_bytes(); }
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] int line() const { return line_; }  ///< of the largest

 private:
  static constexpr double slack = 1.001;  // of rounded sums
  double largest_ = 0.0;
  bool are_whole_ = true;
  int line_ = 0;
};

inline constexpr std::string_view colors_are_bytes =
    ": colors of vertices reach beyond 1 and are whole numbers up to 255: they are taken as sRGB "
    "of 8 bits";
[[nodiscard]] inline std::string colors_left_out(double largest) {
  return ": colors of vertices are left out: they must lie in [0, 1] or be whole numbers in "
         "[0, 255], but one is " +
         number_text(largest);
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
