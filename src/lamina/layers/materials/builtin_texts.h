// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace lamina {

/// A material file of the folder builtin/, put into the library when it is built.
struct BuiltinText {
  std::string_view name;
  std::string_view text;
};

/// In the order of the list in CMakeLists.txt.
[[nodiscard]] std::span<const BuiltinText> builtin_texts();

/// The names of builtin_materials(), without making these, which takes a tenth of a second.
[[nodiscard]] const std::vector<std::string_view>& builtin_material_names();

}  // namespace lamina
