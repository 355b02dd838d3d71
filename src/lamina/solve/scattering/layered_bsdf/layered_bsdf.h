// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"

namespace lamina {

enum class ScatteringOrders {
  first,  ///< light scattered once, and from a ground
  all     ///< with the term of higher orders, sized to give adding-doubling's fluxes
};

/// BRDF and BTDF by the first order in closed form: what the renderer's layered_bsdf evaluates, but
/// under a rough top. Here light goes in and out by facets, where the renderer scales beams of a
/// smooth top by what the facets let through; and all that the surface reflects is in the BRDF.
///
/// @param theta_i, theta_o, phi_o  as for stack_bsdf, which has the truth.
/// @throws InvalidInput for angles out of range and for rough boundaries below the top.
///
/// Source: [HanrahanKrueger1993] §§2, 4-5; see first_order.h, higher_orders.h and rough_top.cpp.
[[nodiscard]] StackBsdf layered_bsdf(const LayerStack& stack, ScatteringOrders orders,
                                     double theta_i, std::span<const double> theta_o,
                                     std::span<const double> phi_o);

/// How much light one BSDF sends elsewhere than another: the integral over the hemisphere of
/// |a - b| cos(theta), over that of b cos(theta).
///
/// @param a, b     [theta_o][phi_o] on the grid of the angles.
/// @param theta_o  equally spaced from 0.
/// @param phi_o    equally spaced over [0, pi], both ends included: a plane of symmetry.
[[nodiscard]] double misplaced_light(std::span<const double> a, std::span<const double> b,
                                     std::span<const double> theta_o,
                                     std::span<const double> phi_o);

}  // namespace lamina
