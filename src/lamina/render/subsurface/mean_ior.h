// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/materials/material.h"

namespace lamina {

/// The index of a material's upper layer over that above it, mean of the bands.
[[nodiscard]] inline float mean_ior(const Material& material) {
  double sum = 0.0;
  for (std::size_t b = 0; b < material.bands.size(); ++b)
    sum += material.layers.front().ior[b] / material.ior_above[b];
  return static_cast<float>(sum / static_cast<double>(material.bands.size()));
}

}  // namespace lamina
