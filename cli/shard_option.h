// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/shard.h"

namespace lamina::cli {

/// "I/N". @throws InvalidInput
[[nodiscard]] Shard read_shard(const std::string& text);

/// The words of this call behind the program's name. main() sets them.
[[nodiscard]] const std::vector<std::string>& words_of_call();
void set_words_of_call(int argc, const char* const* argv);

/// The words without some options, of which those in `with_value` take the word behind them with
/// them, unless they hold it: "--json FILE", "--json=FILE".
[[nodiscard]] std::vector<std::string> without_options(std::span<const std::string> words,
                                                       std::span<const std::string_view> with_value,
                                                       std::span<const std::string_view> flags);

/// Words common to all shards of a call: without shard, output, and what changes no number.
[[nodiscard]] std::vector<std::string> words_of_shards(std::span<const std::string> words);

/// Words as a shell takes them, behind "lamina".
[[nodiscard]] std::string command_line(std::span<const std::string> words);

}  // namespace lamina::cli
