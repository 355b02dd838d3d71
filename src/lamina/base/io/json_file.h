// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace lamina {

/// A JSON file on disk, or one that is not: its text, and where it would lie.
struct JsonFile {
  JsonFile(std::filesystem::path file) : path(std::move(file)) {}  // NOLINT: readers take a path
  JsonFile(const std::string& file) : path(file) {}                // NOLINT
  JsonFile(const char* file) : path(file) {}                       // NOLINT
  JsonFile(std::filesystem::path file, std::string content)
      : path(std::move(file)), text(std::move(content)) {}

  std::filesystem::path path;  ///< what it is called in messages; its folder is where paths begin
  std::optional<std::string> text = {};
};

}  // namespace lamina
