// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lamina/scene/mesh/file_material.h"

namespace lamina {

/// A material of a mesh file in the words of a scene file.
struct SceneMaterialText {
  std::string json;                  ///< what an entry of "materials" holds
  std::vector<std::string> ignored;  ///< what it leaves out, by the names of the mesh file
};

/// The scene material that comes nearest to one of a mesh file:
///
/// - transmission of a half and more: a dielectric;
/// - a volume that attenuates and scatters, or that transmits diffusely: layers of its
///   coefficients, from the albedo of multiple scattering by [KullaConty2017];
/// - diffuse transmission of a thin wall: a thin sheet that reflects and lets through that much of
///   diffuse light;
/// - else a diffuse surface under a boundary.
///
/// Roughness in files is the square root of microfacet alpha.
///
/// @param mm_per_unit  of the mesh file, for lengths of volumes
/// @param uv_set       that the mesh is read with; textures of another one are left out
[[nodiscard]] SceneMaterialText scene_material_text(const FileMaterial& material,
                                                    double mm_per_unit, int uv_set);

}  // namespace lamina
