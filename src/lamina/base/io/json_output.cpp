// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/json_output.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/io/utf8_text.h"

namespace lamina {
namespace {

/// The fewest digits that read back, always with a point or an exponent, as in 3.0, 0.001, 1.5e-07.
std::string floating_text(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 32> buffer{};
  const auto shortest = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                      std::chars_format::scientific);
  const std::string_view text(buffer.data(), shortest.ptr);
  const std::size_t e = text.find('e');
  const int exponent = static_cast<int>(std::strtol(text.data() + e + 1, nullptr, 10));
  const std::string sign = text[0] == '-' ? "-" : "";
  std::string digits;
  for (const char c : text.substr(0, e))
    if ('0' <= c && c <= '9') digits += c;
  if (value == 0.0) return sign + "0.0";
  const auto count = static_cast<int>(digits.size());
  const int before_point = exponent + 1;
  if (before_point > 15 || before_point <= -4) {  // 1e+20, 1.5e-07
    if (count > 1) digits.insert(1, ".");
    return sign + digits + std::string(text.substr(e));
  }
  if (before_point <= 0)
    return sign + "0." + std::string(static_cast<std::size_t>(-before_point), '0') + digits;
  if (count <= before_point)
    return sign + digits + std::string(static_cast<std::size_t>(before_point - count), '0') + ".0";
  return sign + digits.insert(static_cast<std::size_t>(before_point), ".");
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_bytes(text.substr(at));
    if (length == 0) return false;
    at += length;
  }
  return true;
}

std::string json_quoted(std::string_view text) {
  constexpr std::string_view steering = "\"\\\b\f\n\r\t", letters = "\"\\bfnrt";
  std::string quoted = "\"";
  for (std::size_t at = 0, length = 0; at < text.size(); at += std::max<std::size_t>(length, 1)) {
    const char c = text[at];
    length = utf8_bytes(text.substr(at));
    if (length == 0) {
      quoted += "\xef\xbf\xbd";  // U+FFFD
    } else if (const auto known = steering.find(c); known != std::string_view::npos) {
      quoted += '\\';
      quoted += letters[known];
    } else if (static_cast<unsigned char>(c) < 0x20) {
      constexpr std::string_view hexadecimal = "0123456789abcdef";
      quoted += c < 0x10 ? "\\u000" : "\\u001";
      quoted += hexadecimal[static_cast<std::size_t>(c) % 16];
    } else {
      quoted += text.substr(at, length);
    }
  }
  return quoted + '"';
}

JsonOutput::JsonOutput(std::nullptr_t) {}
JsonOutput::JsonOutput(std::string text) : value_(std::move(text)) {}
JsonOutput::JsonOutput(std::string_view text) : value_(std::string(text)) {}
JsonOutput::JsonOutput(const char* text) : value_(std::string(text)) {}
JsonOutput::JsonOutput(Object entries) : value_(std::move(entries)) {}

JsonOutput::JsonOutput(std::initializer_list<Entry> entries) : value_(Object()) {
  for (const Entry& entry : entries) (*this)[entry.key] = entry.value;
}

JsonOutput JsonOutput::object() { return JsonOutput(Object()); }

JsonOutput::JsonOutput(const JsonInput& input) {
  if (input.is_boolean()) {
    value_ = input.boolean();
  } else if (input.is_whole_number() && std::abs(input.number()) < 0x1p53) {
    value_ = static_cast<std::int64_t>(input.number());
  } else if (input.is_number()) {
    value_ = input.number();
  } else if (input.is_string()) {
    value_ = input.string();
  } else if (input.is_array()) {
    value_ = Array();
    for (const JsonInput& element : input.array()) push_back(JsonOutput(element));
  } else if (input.is_object()) {
    value_ = Object();
    for (const auto& [key, value] : input.entries())
      std::get<Object>(value_).push_back({key, JsonOutput(value)});
  }
}

JsonOutput JsonOutput::array(std::initializer_list<JsonOutput> elements) {
  JsonOutput made;
  made.value_ = Array(elements);
  return made;
}

JsonOutput& JsonOutput::operator[](std::string_view key) {
  if (std::holds_alternative<Null>(value_)) value_ = Object();
  auto& entries = std::get<Object>(value_);
  const auto found = std::ranges::find(entries, key, &Entry::key);
  if (found != entries.end()) return found->value;
  entries.push_back({std::string(key), JsonOutput()});
  return entries.back().value;
}

void JsonOutput::update(const JsonOutput& other) {
  if (std::holds_alternative<Null>(value_)) value_ = Object();
  for (const Entry& entry : std::get<Object>(other.value_)) (*this)[entry.key] = entry.value;
}

void JsonOutput::erase(std::string_view key) {
  std::erase_if(std::get<Object>(value_), [&](const Entry& entry) { return entry.key == key; });
}

JsonOutput& JsonOutput::push_back(JsonOutput element) {
  if (std::holds_alternative<Null>(value_)) value_ = Array();
  return std::get<Array>(value_).emplace_back(std::move(element));
}

std::size_t JsonOutput::size() const {
  if (const auto* elements = std::get_if<Array>(&value_)) return elements->size();
  if (const auto* entries = std::get_if<Object>(&value_)) return entries->size();
  return 0;
}

std::string JsonOutput::text(int indent) const {
  std::string text;
  write(text, indent, 0);
  return text;
}

void JsonOutput::write(std::string& text, int indent, std::size_t column) const {
  const std::size_t inner = column + static_cast<std::size_t>(std::max(indent, 0));
  const auto new_line = [&](std::size_t spaces) {
    if (indent >= 0) text += '\n' + std::string(spaces, ' ');
  };
  const auto write_list = [&](const auto& parts, std::string_view brackets, const auto& start) {
    text += brackets[0];
    for (const auto& part : parts) {
      if (&part != &parts.front()) text += ',';
      new_line(inner);
      start(part).write(text, indent, inner);
    }
    if (!parts.empty()) new_line(column);
    text += brackets[1];
  };
  if (const auto* elements = std::get_if<Array>(&value_)) {
    write_list(*elements, "[]", std::identity{});
  } else if (const auto* entries = std::get_if<Object>(&value_)) {
    write_list(*entries, "{}", [&](const Entry& entry) -> const JsonOutput& {
      text += json_quoted(entry.key) + (indent >= 0 ? ": " : ":");
      return entry.value;
    });
  } else if (const auto* string = std::get_if<std::string>(&value_)) {
    text += json_quoted(*string);
  } else if (const auto* number = std::get_if<double>(&value_)) {
    text += floating_text(*number);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value_)) {
    text += std::to_string(*whole);
  } else if (const auto* large = std::get_if<std::uint64_t>(&value_)) {
    text += std::to_string(*large);
  } else if (const auto* truth = std::get_if<bool>(&value_)) {
    text += *truth ? "true" : "false";
  } else {
    text += "null";
  }
}

void JsonOutput::require_numbers(const std::string& place) const {
  if (const auto* number = std::get_if<double>(&value_); number && !std::isfinite(*number))
    throw WriteError("the result has no number, but " + number_text(*number) + ", at " +
                     place.substr(place.starts_with('.') ? 1 : 0));
  if (const auto* elements = std::get_if<Array>(&value_))
    for (std::size_t i = 0; i < elements->size(); ++i)
      (*elements)[i].require_numbers(place + "[" + std::to_string(i) + "]");
  if (const auto* entries = std::get_if<Object>(&value_))
    for (const Entry& entry : *entries) entry.value.require_numbers(place + "." + entry.key);
}

}  // namespace lamina
