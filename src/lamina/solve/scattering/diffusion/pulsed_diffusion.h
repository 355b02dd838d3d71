// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// Light that leaves a stack per area and time around a short pulse in a pencil beam, by diffusion,
/// per arriving light [1/(mm² ps)], [r][t]. Of a half-space in closed form; of layers the diffusion
/// equation at each spatial frequency and at complex rates, with the fluence over n² and the flux
/// the same on both sides of a boundary, transformed back. The source is where the reduced
/// scattering adds up to 1.
///
/// What is too little to be resolved, before 0.3 of the time that light needs to get there or 1e-8
/// of the most over time, is given as that much, so that it has a logarithm.
///
/// @param r  distances [mm], > 0.
/// @param t  times of flight [ps].
/// @throws InvalidInput naming the first layer that does not scatter: light does not diffuse there.
///
/// Source: of the closed form `pulsed_reflectance`; of layers [Kienle1998] §2, here with any number
/// of layers; of the way back from rates [WeidemanTrefethen2007] §4, the hyperbola.
[[nodiscard]] std::vector<std::vector<double>> pulsed_diffusion(const LayerStack& stack,
                                                                std::span<const double> r,
                                                                std::span<const double> t);

/// Pulsed diffusion of layers by transforms, also of a half-space.
[[nodiscard]] std::vector<std::vector<double>> pulsed_diffusion_by_transforms(
    const LayerStack& stack, std::span<const double> r, std::span<const double> t);

}  // namespace lamina
