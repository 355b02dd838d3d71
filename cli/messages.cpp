// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What is said to people, whatever bytes the files have that it is about.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <new>

#include "console.h"
#include "lamina/base/io/utf8_text.h"

namespace lamina::cli {
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
