// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/zero_signs.h"

#include <cctype>
#include <cstddef>

namespace lamina {

std::string without_negative_zeros(std::string_view text) {
  constexpr std::string_view before = " \n\t,;:([", digits = "0123456789";
  std::string out(text);
  for (std::size_t at = 0; (at = out.find('-', at)) != std::string::npos; ++at) {
    if (at > 0 && before.find(out[at - 1]) == std::string_view::npos) continue;
    std::size_t end = at + 1;
    if (out.substr(end, 1) != "0") continue;
    while (end < out.size() && out[end] == '0') ++end;
    if (end < out.size() && out[end] == '.') ++end;
    while (end < out.size() && out[end] == '0') ++end;
    const bool goes_on = end < out.size() && (digits.find(out[end]) != std::string_view::npos ||
                                              std::isalpha(static_cast<unsigned char>(out[end])));
    if (!goes_on) out[at] = ' ';
  }
  return out;
}

}  // namespace lamina
