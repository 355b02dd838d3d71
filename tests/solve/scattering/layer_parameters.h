// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina {

/// Parameter of a layer, one number after the other, for central differences.
struct LayerParameter {
  const char* name;
  double LayerDerivatives::*derivative;
  double& (*value)(Layer&);
};
inline constexpr std::array<LayerParameter, 4> layer_parameters = {{
    {"sigma_a", &LayerDerivatives::by_sigma_a,
     [](Layer& l) -> double& { return l.medium.sigma_a; }},
    {"sigma_s", &LayerDerivatives::by_sigma_s,
     [](Layer& l) -> double& { return l.medium.sigma_s; }},
    {"g", &LayerDerivatives::by_g, [](Layer& l) -> double& { return l.medium.g; }},
    {"thickness", &LayerDerivatives::by_thickness, [](Layer& l) -> double& { return l.thickness; }},
}};

/// The stack with a number of one layer larger.
inline LayerStack changed(const LayerStack& stack, std::size_t layer,
                          const LayerParameter& parameter, double by) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  parameter.value(layers[layer]) += by;
  return LayerStack(layers, stack.ior_above(), stack.ior_below(), stack.ground());
}

}  // namespace lamina
