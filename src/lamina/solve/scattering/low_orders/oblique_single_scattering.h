// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

namespace lamina::detail {

/// Light of an oblique beam that is scattered once and neither before nor after reflected, as
/// `oblique_responses` have it: on the grid, with the azimuths that the modes can tell apart.
[[nodiscard]] std::vector<FrequencyResponse> oblique_single_on_grid(const FrequencySolver& solver,
                                                                    double k);

/// Single scattering at (x, y) [mm] from where the beam comes in, exactly; it goes on towards +x.
/// [1/mm²]
///
/// @param p  ior_above times the sine of the beam's angle
[[nodiscard]] SingleScatteringProfile oblique_single_profile(const LayerStack& stack,
                                                             const GridStack& on_grid, double p,
                                                             double x, double y);

}  // namespace lamina::detail
