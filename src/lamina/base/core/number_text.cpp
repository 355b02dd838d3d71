// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/number_text.h"

#include <locale.h>

#include <array>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace lamina {
namespace {

/// Makes printf and strtod take numbers as C does, on this thread and as long as it lives.
class ClassicNumbers {
 public:
  ClassicNumbers() : before_(uselocale(classic())) {}
  ~ClassicNumbers() { uselocale(before_); }
  ClassicNumbers(const ClassicNumbers&) = delete;
  ClassicNumbers& operator=(const ClassicNumbers&) = delete;

 private:
  static locale_t classic() {
    static const locale_t made = newlocale(LC_ALL_MASK, "C", locale_t{});
    return made;
  }
  locale_t before_;
};

template <class Number>
std::string shortest(Number value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

}  // namespace

std::string number_text(double value) { return shortest(value); }
std::string number_text(float value) { return shortest(value); }

double rounded_number(const std::string& text) {
  const ClassicNumbers classic_numbers;
  return std::strtod(text.c_str(), nullptr);
}

std::string printf_text(const char* format, ...) {
  const ClassicNumbers classic_numbers;
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(values);
  return text;
}

}  // namespace lamina
