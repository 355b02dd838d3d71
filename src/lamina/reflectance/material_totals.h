// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/materials/material.h"
#include "lamina/scattering/profile/profile.h"

namespace lamina {

/// What becomes of diffuse light that has entered a material: the fractions of it that leave above
/// and below.
struct EnteredTotals {
  double reflectance = 0.0, transmittance = 0.0;
};

/// By adding-doubling, to 1e-5. The upper surface and the lowest one count as smooth, their
/// roughness being the renderer's business.
/// @throws InvalidInput as layer_stack.
[[nodiscard]] EnteredTotals exact_totals(const Material& material, std::size_t band);

/// The same for all bands, in parallel, [band].
[[nodiscard]] std::vector<EnteredTotals> exact_totals(const Material& material);

/// A profile per entered flux with the totals of the material by radiative transfer: the shape is
/// kept. What is too little to be told from none stays.
[[nodiscard]] Profile with_exact_totals(Profile profile, const Material& material);

/// The optical layers of a band with a smooth upper surface and a smooth lowest one.
[[nodiscard]] LayerStack stack_with_smooth_ends(const Material& material, std::size_t band);

/// Of all layers but the last [mm].
[[nodiscard]] double thickness_of_upper_layers(const Material& material);

/// A material with an infinite last layer as a thin object: a slab with the same layers on both
/// sides and what is left of the thickness [mm] of the last one between them.
[[nodiscard]] Material make_slab(const Material& material, double thickness);

/// The material with the absorption of each band times a factor, [band]. Where there is none, a
/// thousandth of the reduced scattering stands in, so that it can be made darker.
[[nodiscard]] Material with_absorption(Material material, const std::vector<double>& factor);

/// The material whose exact totals of reflectance are given, [band], by its absorption. Where no
/// absorption between a 64th and 3000 times its own gives them it has the nearest ones.
[[nodiscard]] Material with_reflectance(const Material& material,
                                        const std::vector<double>& reflectance);

}  // namespace lamina
