// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lamina/mesh/file_material.h"

namespace lamina {

/// The materials of a Wavefront MTL file: Kd, map_Kd, Ks, Ns, Ni, d, Tr, Ke, bump, norm, and Pr and
/// Pm of the extension for physically based materials. The exponent of Phong is taken as the
/// Beckmann roughness of the same peak, alpha = sqrt(2 / (Ns + 2)) [Walter2007].
/// @throws FileError naming the line of a number that is not one
[[nodiscard]] std::vector<FileMaterial> parse_mtl(std::string_view text, const std::string& name);

}  // namespace lamina
