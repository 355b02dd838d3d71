// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/json_file.h"

namespace lamina::python {

namespace py = pybind11;

/// A path, or a dict as text with the path where it would lie.
[[nodiscard]] inline JsonFile json_file(const std::string& path,
                                        const std::optional<std::string>& text) {
  return text ? JsonFile(path, *text) : JsonFile(path);
}

/// Result of `load(file)`, without Python's lock. Lines of a dict in messages help
/// nobody: "scene: film.width must be …".
template <class F>
auto load_unlocked(const JsonFile& file, const F& load) {
  const py::gil_scoped_release unlocked;
  try {
    return load(file);
  } catch (const InvalidInput& error) {
    const std::string message = error.what(), place = file.path.string() + ":1: ";
    if (!file.text || !message.starts_with(place)) throw;
    throw InvalidInput(file.path.filename().string() + ": " + message.substr(place.size()));
  }
}

}  // namespace lamina::python
