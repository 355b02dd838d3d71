// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "lamina/base/core/error.h"
#include "lamina/base/core/memory_budget.h"

// What the fuzz targets share. Whatever the bytes, a reader reads them or throws lamina's own
// error: any other exception, a crash, a hang or a sanitizer's finding is a bug.
namespace lamina::fuzz {

/// Memory that a target may take [bytes]: libFuzzer's own limit is above it.
inline constexpr std::size_t most_memory = std::size_t{256} << 20;

[[nodiscard]] inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs `read`, which may refuse its input.
/// @return  0, as libFuzzer's entry must
template <class Read>
int read_or_refuse(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
  return 0;
}

/// The file that JSON of the corpus `kind` is said to be: files that it names lie beside it.
[[nodiscard]] std::filesystem::path corpus_file(const char* kind);

/// A folder of this process alone, which is removed at its end.
[[nodiscard]] const std::filesystem::path& scratch_folder();

/// Writes a file there. @return  its path
std::filesystem::path scratch_file(const std::string& name, std::string_view bytes);

}  // namespace lamina::fuzz
