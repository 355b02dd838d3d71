// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/skin_layer_maps.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace lamina {
namespace {

bool has_skin_maps(const SurfaceMaterial& material) {
  const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface);
  return surface && !surface->skin_maps.empty();
}

}  // namespace

std::optional<Scene> with_skin_maps_as_layer_maps(const Scene& scene) {
  if (scene.render.method != RenderSettings::Method::layered_bsdf ||
      std::ranges::none_of(scene.materials, has_skin_maps))
    return std::nullopt;
  Scene changed = scene;
  for (SurfaceMaterial& material : changed.materials) {
    if (!has_skin_maps(material)) continue;
    auto& surface = std::get<SubsurfaceSurface>(material.surface);
    for (SkinMap& map : surface.skin_maps) {
      const auto ranges = skin_parameter_ranges();
      const auto range = std::ranges::find(ranges, map.name, &SkinParameterRange::name);
      changed.images.push_back(std::move(map.values));
      surface.maps.push_back(
          {.quantity = LayerMap::Quantity::skin,
           .part = static_cast<std::size_t>(range - ranges.begin()),
           .terms = {{.map = TextureMap{.source = ImageMap{.image = changed.images.size() - 1}}}}});
    }
    surface.skin_maps.clear();
  }
  return changed;
}

}  // namespace lamina
