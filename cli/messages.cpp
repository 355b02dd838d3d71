// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What is said to people, whatever bytes the files have that it is about.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <new>

#include "console.h"

namespace lamina::cli {
namespace {

/// Bytes of the character of UTF-8 that the text begins with; 0 if it is none, or one that moves
/// the cursor, colors the text or turns the direction of reading.
std::size_t printable_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  unsigned point = first & (0xffu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0u) != 0x80) return 0;
    point = point << 6 | (byte(i) & 0x3fu);
  }
  const unsigned least = size == 2 ? 0x80 : size == 3 ? 0x800 : 0x10000;
  const bool is_surrogate = point >= 0xd800 && point <= 0xdfff;
  const bool is_control = point < 0xa0 || point == 0x61c || (point >= 0x200b && point <= 0x200f) ||
                          (point >= 0x2028 && point <= 0x202e) ||
                          (point >= 0x2066 && point <= 0x2069);
  return point < least || point > 0x10ffff || is_surrogate || is_control ? 0 : size;
}

}  // namespace

std::string printable(std::string_view text, std::string_view also) {
  std::string shown;
  while (!text.empty()) {
    std::size_t size = printable_bytes(text);
    if (size == 0 && also.find(text[0]) != std::string_view::npos) size = 1;
    if (size > 0)
      shown += text.substr(0, size);
    else
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    text.remove_prefix(size > 0 ? size : 1);
  }
  return shown;
}

void say(std::string_view message) try {
  constexpr std::size_t longest = 2000, end = 500;  // its end says what is wrong, as a rule
  std::string line(message);
  if (line.size() > longest) line.replace(longest - end, line.size() - longest, " ... ");
  if (isatty(STDERR_FILENO)) std::fputs("\r\033[K", stderr);  // the bar may be there
  // Where this cannot be written there is nowhere else to say so.
  std::fputs(fmt::format("lamina: {}\n", printable(line, "")).c_str(), stderr);
} catch (const std::bad_alloc&) {
  std::fputs("lamina: not enough memory\n", stderr);
}

}  // namespace lamina::cli
