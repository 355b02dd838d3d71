// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "lamina/base/core/memory_budget.h"

namespace lamina {

/// An image inside a glTF file, as scene files name it: `head.glb#2`.
struct GltfImageName {
  std::filesystem::path file;
  std::size_t index = 0;
};

/// Absent if the path names no such image.
[[nodiscard]] std::optional<GltfImageName> gltf_image_name(const std::filesystem::path& path);

/// The bytes of the image, a PNG or JPEG.
/// @throws FileError, InvalidInput if the file has no such image inside.
[[nodiscard]] std::string load_gltf_image(const GltfImageName& name, MemoryBudget& memory);

}  // namespace lamina
