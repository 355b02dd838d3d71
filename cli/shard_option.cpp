// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "shard_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "lamina/base/core/error.h"
#include "lamina/base/io/shell_text.h"

namespace lamina::cli {
namespace {

std::vector<std::string>& kept_words() {
  static std::vector<std::string> words;
  return words;
}

}  // namespace

Shard read_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec == std::errc() && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    if (count.ec == std::errc() && count.ptr == end && shard.count >= 1 && shard.index >= 0 &&
        shard.index < shard.count)
      return shard;
  }
  throw InvalidInput(
      fmt::format("--shard: must be I/N with 0 <= I < N, such as 0/4, but is \"{}\"", text));
}

const std::vector<std::string>& words_of_call() { return kept_words(); }

void set_words_of_call(int argc, const char* const* argv) {
  kept_words().assign(argv + std::min(argc, 1), argv + argc);
}

std::vector<std::string> without_options(std::span<const std::string> words,
                                         std::span<const std::string_view> with_value,
                                         std::span<const std::string_view> flags) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (std::ranges::find(flags, word) != flags.end()) continue;
    if (std::ranges::find(with_value, word) != with_value.end()) {
      ++i;
      continue;
    }
    const bool holds_value = std::ranges::any_of(with_value, [&](std::string_view option) {
      return option.starts_with("--") ? word.starts_with(std::string(option) + "=")
                                      : word.starts_with(option);
    });
    if (!holds_value) kept.push_back(word);
  }
  return kept;
}

std::vector<std::string> words_of_shards(std::span<const std::string> words) {
  constexpr std::array<std::string_view, 7> with_value = {
      "--shard", "-o", "--output", "--json", "--threads", "--checkpoint", "--memory-budget"};
  constexpr std::array<std::string_view, 1> flags = {"--resume"};
  return without_options(words, with_value, flags);
}

std::string command_line(std::span<const std::string> words) {
  std::string line = "lamina";
  for (const std::string& word : words) line += ' ' + shell_quoted(word);
  return line;
}

}  // namespace lamina::cli
