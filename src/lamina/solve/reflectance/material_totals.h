// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Totals of diffuse light that has entered a material: the fractions of it that leave above
/// and below.
struct EnteredTotals {
  double reflectance = 0.0, transmittance = 0.0;
};

/// By adding-doubling, to 1e-5. The upper surface and the lowest one count as smooth, their
/// roughness being the renderer's business.
[[nodiscard]] EnteredTotals material_totals(const LayerStack& layers);

/// Totals of all bands, in parallel, [band].
[[nodiscard]] std::vector<EnteredTotals> material_totals(std::span<const LayerStack> bands);

/// A profile per entered flux with the totals of its layers by radiative transfer, [band]: the
/// shape is kept. What is too little to be told from none stays.
[[nodiscard]] Profile with_material_totals(Profile profile, std::span<const LayerStack> bands);

/// Layers with a smooth upper surface and a smooth lowest one.
[[nodiscard]] LayerStack with_smooth_ends(const LayerStack& stack);

/// Layers with a smooth lowest surface.
[[nodiscard]] LayerStack with_smooth_bottom(const LayerStack& stack);

/// The layers with their absorption times a factor. Where there is none, a thousandth of the
/// reduced scattering stands in, so that it can be made darker.
[[nodiscard]] LayerStack with_absorption(const LayerStack& stack, double factor);

/// The material whose totals of reflectance are given, [band], by its absorption. Where no
/// absorption between a 64th and 3000 times its own gives them it has the nearest ones.
/// @throws InvalidInput as layer_stack.
[[nodiscard]] Material with_reflectance(const Material& material,
                                        const std::vector<double>& reflectance);

}  // namespace lamina
