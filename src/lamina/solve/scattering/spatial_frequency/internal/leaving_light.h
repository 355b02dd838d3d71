// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {

/// Light that arrives from above.
struct ArrivingLight {
  std::vector<double> state;
  double flux = 1.0;
  double mirrored = 0.0;  ///< of that what the top alone throws back, and responses leave out
};
[[nodiscard]] ArrivingLight arriving_light(const FrequencySolver& solver,
                                           Illumination illumination);

/// Weights of the states outside in the flux that leaves: mode 0 in all directions but the beams'.
///
/// @param ior  above or below.
[[nodiscard]] std::vector<double> weights_of_flux(const FrequencySolver& solver, double ior);

[[nodiscard]] FrequencyResponse leaving_flux(const FrequencySolver& solver,
                                             const StackAtFrequency& at, std::vector<double> state);

/// Response over what arrives, less what the top throws back.
[[nodiscard]] FrequencyResponse response_to(const FrequencySolver& solver,
                                            const StackAtFrequency& at,
                                            const ArrivingLight& arriving);

}  // namespace lamina::detail
