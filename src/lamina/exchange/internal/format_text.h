// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/io/json_output.h"
#include "lamina/exchange/export_format.h"

// What the files of several formats say alike.

namespace lamina::detail {

/// Lines at the head of every file, without marks of a comment: the material, where
/// its numbers come from, what wrote it and for what, units.
/// @param written_for  the program and its version, as "pbrt-v4"
[[nodiscard]] std::vector<std::string> head_lines(const ExportInput& input,
                                                  std::string_view written_for);

/// The line of them that says which channels the numbers are of.
[[nodiscard]] std::string channels_text(const ExportInput& input);

/// The misfits and notes as such lines.
[[nodiscard]] std::vector<std::string> misfit_lines(std::span<const ChannelMisfit> misfits);

/// Lines as a comment: each behind `mark`, as "# ", by one_line.
[[nodiscard]] std::string comment(std::span<const std::string> lines, std::string_view mark);

/// Lines as a comment of XML, which holds no "--".
[[nodiscard]] std::string xml_comment(std::span<const std::string> lines);

/// The first lines of a script of Python. A comment in the first two lines of one may name an
/// encoding in which escapes end the comment, so the first line of this names UTF-8, and no text of
/// others is in it: what it says of the material belongs into literals.
/// @param lines  those that follow, without text of others
[[nodiscard]] std::string python_head(std::string_view written_for,
                                      std::span<const std::string> lines);

/// Text as a literal of Python.
[[nodiscard]] std::string python_literal(std::string_view text);

/// Text of others without characters that end a line for any reader, that steer a terminal or the
/// direction of writing, or that no file of XML may hold: a space stands for each.
[[nodiscard]] std::string one_line(std::string_view text);

/// Numbers with a space between.
[[nodiscard]] std::string numbers_text(std::span<const double> values,
                                       std::string_view separator = " ");

/// Head of JSON files: as head_lines, as an object.
[[nodiscard]] JsonOutput head_json(const ExportInput& input, std::string_view format);

}  // namespace lamina::detail
