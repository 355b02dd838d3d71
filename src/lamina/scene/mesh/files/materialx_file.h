// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/core/memory_budget.h"
#include "lamina/scene/mesh/file_material.h"

namespace lamina {

/// The materials of a MaterialX file (.mtlx): surfaces by OpenPBR, Standard Surface or the surface
/// of glTF, whose inputs are values or images. Other nodes between an image and an input are left
/// out, with a line that names them. Subsurface is taken where its weight is a half and more, its
/// radius as the mean free path in scene units.
/// @throws FileError naming the file; InvalidInput
[[nodiscard]] std::vector<FileMaterial> load_materialx(const std::filesystem::path& file,
                                                       MemoryBudget& memory);

/// Parses the bytes of a file; `name` stands for it in messages.
[[nodiscard]] std::vector<FileMaterial> parse_materialx(std::string_view text,
                                                        const std::string& name);

}  // namespace lamina
