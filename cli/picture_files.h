// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace lamina::cli {

/// Where a picture goes; "": not wanted.
struct PictureFiles {
  std::string exr, png;
};

/// Files that --output asks for. NAME.exr or NAME.png is that file. Without an ending, or with one
/// that starts with a digit, as of the frame in beauty.0001, it is NAME.exr and NAME.png. In a
/// folder, or without the option, they are named after the file that the picture is made from.
///
/// @param output  of the option, or ""
/// @param source  the scene or patch, "-" for standard input
/// @throws InvalidInput for any other ending; WriteError if a file cannot be written
[[nodiscard]] PictureFiles picture_files(const std::string& output, const std::string& source);

/// A result's name in the current folder where --output does not say one: that of what it is made
/// from, without its ending.
///
/// @param what  the result, for messages: "picture"
/// @throws InvalidInput for standard input, and for what leaves no name, as "...json"
[[nodiscard]] std::string named_after(const std::string& source, const std::string& what);

/// "1.20 % noise, 3.41 % root mean square, ": what is known of base/image/compare.h's.
[[nodiscard]] std::string describe_noise(const std::optional<double>& median,
                                         const std::optional<double>& rms);

}  // namespace lamina::cli
