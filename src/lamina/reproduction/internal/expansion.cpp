// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/reproduction/internal/expansion.h"

#include <charconv>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lamina::detail {
namespace {

constexpr std::size_t most_elements = 10'000;

/// What names in braces stand for.
using Variables = std::vector<std::pair<std::string, std::string>>;

/// `{name}` and `{draft|full}` in a text; other braces stay.
std::string replaced(const std::string& text, const Variables& variables, bool is_full) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t end = text[i] == '{' ? text.find_first_of("{}", i + 1) : std::string::npos;
    if (end == std::string::npos || text[end] != '}') {
      result += text[i];
      continue;
    }
    const std::string inner = text.substr(i + 1, end - i - 1);
    std::optional<std::string> value;
    for (const auto& [name, stands_for] : variables)
      if (name == inner) value = stands_for;
    const std::size_t bar = inner.find('|');
    if (!value && bar != std::string::npos)
      value = is_full ? inner.substr(bar + 1) : inner.substr(0, bar);
    if (!value) {
      result += text[i];
      continue;
    }
    result += *value;
    i = end;
  }
  return result;
}

/// Every combination of the lists of a "for".
std::vector<Variables> combinations(const JsonInput& loop) {
  std::vector<Variables> all = {{}};
  for (const auto& [name, list] : loop.entries()) {
    std::vector<Variables> more;
    for (const Variables& before : all)
      for (const JsonInput& value : list.array(1)) {
        Variables& one = more.emplace_back(before);
        one.emplace_back(name, value.is_string() ? value.string() : JsonOutput(value).text());
        if (more.size() > most_elements) loop.fail("makes more than 10 000 elements");
      }
    all = std::move(more);
  }
  return all;
}

JsonOutput expand(const JsonInput& input, const Variables& variables, bool is_full) {
  if (input.is_string()) {
    const std::string text = input.string(), now = replaced(text, variables, is_full);
    // What is nothing but a name in braces may stand for a number.
    if (text.starts_with('{') && text.find('}') == text.size() - 1 && now != text) {
      double number = 0.0;
      const auto [stopped, error] = std::from_chars(now.data(), now.data() + now.size(), number);
      if (error == std::errc() && stopped == now.data() + now.size()) return number;
    }
    return now;
  }
  if (input.is_array()) {
    JsonOutput result = JsonOutput::array();
    for (const JsonInput& element : input.array()) {
      const std::optional<JsonInput> loop =
          element.is_object() ? element.peek("for") : std::nullopt;
      if (!loop) {
        result.push_back(expand(element, variables, is_full));
        continue;
      }
      for (Variables& inner : combinations(*loop)) {
        inner.insert(inner.begin(), variables.begin(), variables.end());
        result.push_back(expand(element, inner, is_full));
        result.back().erase("for");
      }
    }
    return result;
  }
  if (!input.is_object()) return JsonOutput(input);
  JsonOutput result = JsonOutput::object();
  for (const auto& [key, value] : input.entries())
    result[replaced(key, variables, is_full)] = expand(value, variables, is_full);
  return result;
}

}  // namespace

JsonOutput expanded(const JsonInput& input, bool is_full) { return expand(input, {}, is_full); }

}  // namespace lamina::detail
