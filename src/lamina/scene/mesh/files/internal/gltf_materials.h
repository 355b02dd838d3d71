// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "lamina/base/io/json_input.h"
#include "lamina/scene/mesh/file_material.h"

namespace lamina {

/// Materials of a glTF file, by index: metallic-roughness and the extensions that
/// FileMaterial has a place for; the names of all others are listed as ignored.
/// Source: [glTF2] §3.9, and the extensions KHR_materials_*.
[[nodiscard]] std::vector<FileMaterial> decode_gltf_materials(const JsonInput& root,
                                                              const std::filesystem::path& file);

/// The material of primitives that name none. Source: [glTF2] §3.7.2.1, §3.9.6.
[[nodiscard]] FileMaterial default_gltf_material();

}  // namespace lamina
