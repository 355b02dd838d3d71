// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/exchange/export_format.h"
#include "lamina/io/json_output.h"

// What the files of several formats say alike.

namespace lamina::detail {

/// What every file states of itself, a line each, without marks of a comment: the material, where
/// its numbers come from, what wrote it and for what, units.
/// @param written_for  the program and its version, as "pbrt-v4"
[[nodiscard]] std::vector<std::string> head_lines(const ExportInput& input,
                                                  std::string_view written_for);

/// The misfits and notes as such lines.
[[nodiscard]] std::vector<std::string> misfit_lines(std::span<const ChannelMisfit> misfits);

/// Lines as a comment: each behind `mark`, as "# ". What no line may hold is replaced.
[[nodiscard]] std::string comment(std::span<const std::string> lines, std::string_view mark);

/// Text of others without what would end a line or a comment.
[[nodiscard]] std::string one_line(std::string_view text);

/// Numbers with a space between.
[[nodiscard]] std::string numbers_text(std::span<const double> values,
                                       std::string_view separator = " ");

/// What JSON files state: the same as head_lines, as an object.
[[nodiscard]] JsonOutput head_json(const ExportInput& input, std::string_view format);

}  // namespace lamina::detail
