// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/error.h"

namespace lamina {

/// A word of a command line, so that a POSIX shell takes it as it is: in single quotes unless it is
/// plain.
[[nodiscard]] inline std::string shell_quoted(std::string_view word) {
  const auto is_plain = [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
           std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, is_plain)) return std::string(word);
  std::string quoted = "'";
  for (const char c : word)
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  return quoted + "'";
}

/// The words of a command line as a POSIX shell parts them: at spaces outside of quotes. What a
/// shell would replace, such as $HOME and *, stays as it is.
/// @throws InvalidInput if a quote is not closed.
[[nodiscard]] inline std::vector<std::string> shell_words(std::string_view line) {
  std::vector<std::string> words;
  bool is_in_word = false;
  char quote = 0;
  const auto add = [&](char c) {
    if (!is_in_word) words.emplace_back();
    is_in_word = true;
    if (c != 0) words.back() += c;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool is_escape =
        c == '\\' && quote != '\'' && i + 1 < line.size() &&
        (quote == 0 || std::string_view("\\\"$`").find(line[i + 1]) != std::string_view::npos);
    const bool is_blank = quote == 0 && (c == ' ' || c == '\t' || c == '\n');
    const bool opens = quote == 0 && (c == '\'' || c == '"');
    if (is_escape)
      add(line[++i]);
    else if (c == quote)
      quote = 0;
    else if (opens)
      add(0), quote = c;
    else if (is_blank)
      is_in_word = false;
    else
      add(c);
  }
  if (quote != 0)
    throw InvalidInput("the command must close its quotes, but is " + std::string(line));
  return words;
}

}  // namespace lamina
