// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/material_layer_maps.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

bool has_material_maps(const SurfaceMaterial& material) {
  const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface);
  return surface && !surface->material_maps.empty();
}

/// The quantity of layers that a map is; of coefficients the map over its mean, a factor.
LayerMap layer_map(const MaterialMap& from, const std::string& material) {
  using Of = MappableNumber::Of;
  using Quantity = LayerMap::Quantity;
  const MappableNumber& number = from.number;
  LayerMap map{.layer = number.layer, .part = number.part};
  if (number.of == Of::skin)
    map.quantity = Quantity::skin;
  else if (number.of == Of::thickness)
    map.quantity = Quantity::thickness;
  else if (number.of == Of::fraction)
    map.quantity = Quantity::fraction;
  else if (number.of == Of::sigma_a)
    map.quantity = Quantity::sigma_a;
  else if (number.of == Of::sigma_s)
    map.quantity = Quantity::sigma_s;
  else
    throw InvalidInput("material \"" + material + "\": a map of " + number.name +
                       " is not for method layered_bsdf, but for texture_space");
  if (from.values.channel_count() > 1)
    throw InvalidInput("material \"" + material + "\": a map of " + number.name +
                       " by band is not for method layered_bsdf, but for texture_space");
  TextureMap texture;
  if (map.quantity == Quantity::sigma_a || map.quantity == Quantity::sigma_s)
    if (const double mean = means_of(from).front(); mean > 0.0)
      texture.scale = static_cast<float>(1.0 / mean);
  map.terms = {{.map = texture}};
  return map;
}

}  // namespace

std::optional<Scene> with_material_maps_as_layer_maps(const Scene& scene) {
  if (scene.render.method != RenderSettings::Method::layered_bsdf ||
      std::ranges::none_of(scene.materials, has_material_maps))
    return std::nullopt;
  Scene changed = scene;
  for (SurfaceMaterial& material : changed.materials) {
    if (!has_material_maps(material)) continue;
    auto& surface = std::get<SubsurfaceSurface>(material.surface);
    for (MaterialMap& from : surface.material_maps) {
      LayerMap map = layer_map(from, material.name);
      changed.images.push_back(std::move(from.values));
      map.terms[0].map->source = ImageMap{.image = changed.images.size() - 1};
      surface.maps.push_back(std::move(map));
    }
    surface.material_maps.clear();
  }
  return changed;
}

}  // namespace lamina
