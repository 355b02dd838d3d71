// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/symmetric_slab.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace lamina {

double thickness_of_upper_layers(const LayerStack& stack) {
  double total = 0.0;
  for (const Layer& layer : stack.layers().first(stack.layers().size() - 1))
    total += layer.thickness;
  return total;
}

LayerStack make_slab(const LayerStack& stack, double thickness) {
  return slab_with_inner_thickness(
      stack, std::max(thickness - 2.0 * thickness_of_upper_layers(stack), 0.1 * thickness));
}

LayerStack slab_with_inner_thickness(const LayerStack& stack, double inner) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  const std::size_t upper = layers.size() - 1;
  layers.back().thickness = inner;
  for (std::size_t i = upper; i-- > 0;) {
    Layer layer = stack.layers()[i];
    layer.top = stack.layers()[i + 1].top;
    layers.push_back(layer);
  }
  return LayerStack(std::move(layers), stack.ior_above(), stack.ior_above(),
                    {.top = stack.layers().front().top});
}

}  // namespace lamina
