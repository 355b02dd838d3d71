// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <locale>
#include <sstream>
#include <string>

namespace lamina {

// Numbers as text that is the same whatever locale the program has that lamina is part of: a
// decimal point, no separators of thousands.

/// A stream that collects text.
class PlainTextStream : public std::ostringstream {
 public:
  PlainTextStream() { imbue(std::locale::classic()); }
};

/// The fewest digits that read back to the same number.
[[nodiscard]] std::string number_text(double value);
[[nodiscard]] std::string number_text(float value);

/// The number that a text spells: if too large, an infinite one, if too small, 0.
[[nodiscard]] double rounded_number(const std::string& text);

/// Text that printf would print.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string printf_text(const char* format, ...);

}  // namespace lamina
