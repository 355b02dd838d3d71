// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/scene/mesh/file_material.h"

namespace lamina {

struct MtlFile {
  std::vector<FileMaterial> materials;
  std::vector<std::string> notes;  ///< one line each, that begins with the file and its line
};

/// The materials of a Wavefront MTL file: Kd, map_Kd, Ks, Ns, Ni, d, Tr, Ke, bump, norm, and Pr and
/// Pm of the extension for physically based materials. The exponent of Phong is taken as the
/// Beckmann roughness of the same peak, alpha = sqrt(2 / (Ns + 2)) [Walter2007].
///
/// A texture whose path is absolute or leads out of the folder, as those of another computer do, is
/// taken from the file's own folder if it lies there; a note says so, or that it is left out.
/// @param folder  of the file, seen from the mesh file; textures get it in front
/// @throws FileError naming the line of a number that is not one
[[nodiscard]] MtlFile parse_mtl(std::string_view text, const std::filesystem::path& file,
                                const std::filesystem::path& folder);

}  // namespace lamina
