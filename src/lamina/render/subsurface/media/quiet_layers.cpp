// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/media/quiet_layers.h"

namespace lamina {

Material quiet_layers(Material material) {
  for (MaterialLayer& layer : material.layers) {
    layer.top = {};
    layer.ior = material.layers.front().ior;
  }
  return material;
}

bool is_better_quiet(const SubsurfaceSurface& surface) {
  return surface.material.layers.size() == 1 || !surface.material_maps.empty();
}

}  // namespace lamina
