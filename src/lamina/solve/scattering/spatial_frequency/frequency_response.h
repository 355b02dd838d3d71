// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// Fractions of the beam's flux that leave at the top and bottom as a wave J0(k r), scattered by a
/// layer or spread by a rough top; what the top alone throws back is left out.
struct FrequencyResponse {
  double reflectance = 0.0, transmittance = 0.0;
};

/// All orders of scattering. At k = 0 the diffuse totals on the same grid.
[[nodiscard]] FrequencyResponse response(const FrequencySolver& solver, double k);

/// Responses at several frequencies, best as many as `slabs_at_once` and neighbours.
[[nodiscard]] std::vector<FrequencyResponse> responses(const FrequencySolver& solver,
                                                       std::span<const double> frequencies);

/// Responses to diffuse light that falls on the top as a wave, equal radiance from all of the
/// hemisphere: fractions of its flux. With the light that finds its way unscattered; only what the
/// top surface mirrors is left out.
[[nodiscard]] std::vector<FrequencyResponse> diffuse_responses(const FrequencySolver& solver,
                                                               std::span<const double> frequencies);

/// Responses to a beam from the first oblique direction: scattered light that leaves,
/// [frequency][mode]: times (-1)^m c_m J_m(k r) cos(m phi), summed over the modes and integrated
/// over k, it makes the profile over the plane. The angle phi starts where the beam goes to. Mode 0
/// is the response with azimuth averaged.
[[nodiscard]] std::vector<std::vector<FrequencyResponse>> oblique_responses(
    const FrequencySolver& solver, std::span<const double> frequencies);

/// Light scattered once, all its reflections before and after included, on the same grid: what is
/// taken out of `response` to be put in exactly over radius.
[[nodiscard]] FrequencyResponse single_scattering_response(const FrequencySolver& solver, double k);

}  // namespace lamina::detail
