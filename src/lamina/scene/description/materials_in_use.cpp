// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/materials_in_use.h"

#include <variant>

namespace lamina {

std::vector<bool> materials_in_use(const Scene& scene) {
  std::vector<bool> is_used(scene.materials.size(), scene.meshes.empty());
  for (const Mesh& mesh : scene.meshes)
    for (const std::uint32_t material : mesh.material)
      if (material < is_used.size()) is_used[material] = true;
  return is_used;
}

std::vector<std::uint32_t> translucent_materials_in_use(const Scene& scene) {
  std::vector<std::uint32_t> found;
  const std::vector<bool> is_used = materials_in_use(scene);
  for (std::uint32_t m = 0; m < is_used.size(); ++m)
    if (is_used[m] && std::holds_alternative<SubsurfaceSurface>(scene.materials[m].surface))
      found.push_back(m);
  return found;
}

}  // namespace lamina
