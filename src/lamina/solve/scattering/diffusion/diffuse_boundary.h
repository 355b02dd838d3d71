// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/layer_response.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Reflectance that a boundary has for diffuse light inside.
enum class DiffuseFresnel {
  exact,  ///< `fresnel_diffuse`; of a rough boundary all light, whatever facets it meets
  /// To reproduce papers: `fresnel_diffuse_polynomial`, which changes totals by .001; of a rough
  /// boundary the Torrance-Sparrow BRDF alone, which takes light that meets several facets for
  /// transmitted: the totals of marble of roughness 1 rise by .05.
  polynomial
};

/// Choices that all diffusion models share.
struct DiffusionOptions {
  DiffuseFresnel fresnel = DiffuseFresnel::exact;
  Interreflections interreflections = Interreflections::all;  ///< between layers
};

/// Fraction of the diffuse light inside a medium that its boundary turns back, total reflection
/// included: F_dr of a smooth boundary, rho_d of a rough one. Reciprocity holds: 1 - rho_d is (1 -
/// rho_d from outside) / n^2, to the 2e-3 of the table.
///
/// @param ior_inside, ior_outside  indices on the side of the light and beyond, > 0.
/// @return                         in [0, 1).
///
/// Source: [DonnerJensen2005] Eqs. 8 and 23, where the print leaves open that total reflection
/// belongs to rho_d: without it a rough medium of index 1.4 would keep 8 % instead of 53 %. The
/// print's rho_d is that of one facet.
[[nodiscard]] double diffuse_reflectance_inside(const Interface& boundary, double ior_inside,
                                                double ior_outside, DiffuseFresnel fresnel);

/// Reflectance for diffuse light outside, all of it, whatever facets it meets: by reciprocity 1 -
/// n^2 / (1 (1
/// - rho_d).
[[nodiscard]] double diffuse_reflectance_outside(const Interface& boundary, double ior_outside,
                                                 double ior_inside);

/// A = (1 + f) / (1 - f), by which the reflectance f in [0, 1) of a boundary for diffuse light from
/// inside raises the fluence there. Source: [DonnerJensen2005] Eqs. 7 and 24.
[[nodiscard]] double fluence_ratio(double reflectance_inside);

/// Distance z_b = 2 A D beyond a boundary at which the fluence, drawn on as a straight line,
/// vanishes [mm]; the medium must scatter. Source: [DonnerJensen2005] §2.
[[nodiscard]] double extrapolation_distance(const Medium& medium, double reflectance_inside);

/// Fraction of the arriving light that passes the top surface of a stack: 1 - fresnel, or rho_dt of
/// a rough surface. The remainder is the specular reflectance.
///
/// Source: [DonnerJensen2005] Eqs. 2 and 26.
[[nodiscard]] double entry_transmittance(const LayerStack& stack, const Incidence& incidence);

}  // namespace lamina
