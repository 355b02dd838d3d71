// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "picture_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "console.h"
#include "lamina/base/core/error.h"

namespace lamina::cli {
namespace {

namespace fs = std::filesystem;

/// The files, whether or not they can be written.
PictureFiles files_of(const std::string& output, const std::string& source) {
  std::error_code ignored;
  if (output.empty() || fs::is_directory(output, ignored)) {
    const std::string name = (fs::path(output) / named_after(source, "picture")).string();
    return {name + ".exr", name + ".png"};
  }
  const std::string ending = lower_case_ending(output);
  if (ending == ".exr") return {output, ""};
  if (ending == ".png") return {"", output};
  const bool is_number = ending.size() > 1 && '0' <= ending[1] && ending[1] <= '9';
  if (!ending.empty() && !is_number)
    throw InvalidInput("--output: must end in .exr or .png, or in neither for both, but is " +
                       output);
  return {output + ".exr", output + ".png"};
}

}  // namespace

std::string named_after(const std::string& source, const std::string& what) {
  if (source == "-")
    throw InvalidInput(
        fmt::format("--output: must name the {} of what standard input describes", what));
  const std::string name = fs::path(source).stem().string();
  if (name.empty() || name == "." || name == "..")
    throw InvalidInput(fmt::format("--output: must name the {}, which cannot be named after {}",
                                   what, printable(source, "")));
  return name;
}

PictureFiles picture_files(const std::string& output, const std::string& source) {
  const PictureFiles files = files_of(output, source);
  require_writable(files.exr);
  require_writable(files.png);
  return files;
}

std::string describe_noise(const std::optional<double>& median, const std::optional<double>& rms) {
  return (median ? fmt::format("{:.2f} % noise, ", 100.0 * *median) : "") +
         (rms ? fmt::format("{:.2f} % root mean square, ", 100.0 * *rms) : "");
}

}  // namespace lamina::cli
