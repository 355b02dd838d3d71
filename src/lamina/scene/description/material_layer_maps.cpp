// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/material_layer_maps.h"

#include "lamina/base/core/error.h"

namespace lamina {

LayerMap layer_map(const MaterialMap& from, const std::string& material, std::size_t image) {
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
  TextureMap texture{.source = ImageMap{.image = image}};
  if (map.quantity == Quantity::sigma_a || map.quantity == Quantity::sigma_s)
    if (const double mean = means_of(from).front(); mean > 0.0)
      texture.scale = static_cast<float>(1.0 / mean);
  map.terms = {{.map = texture}};
  return map;
}

}  // namespace lamina
