// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"
#include "lamina/solve/scattering/spatial_frequency/differentiated_solver.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"

namespace lamina::detail {

/// A response and its derivatives by what layers are made of.
struct FrequencyDerivatives {
  FrequencyResponse response;
  std::vector<LayerDerivatives> reflectance, transmittance;  ///< [layer]
};

/// `response` or `diffuse_responses` and its derivatives: doubling differentiated in forward mode
/// by three parameters of each layer, thickness by one more thin slice, and the stack by
/// reciprocity. Differentiates the solution on the grid, to rounding.
[[nodiscard]] FrequencyDerivatives response_derivatives(const DifferentiatedSolver& differentiated,
                                                        Illumination illumination, double k);

}  // namespace lamina::detail
