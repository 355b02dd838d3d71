// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/optics/phase_function.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {

/// One way of light that is scattered once to the outside: from a depth in the layer `source` to
/// its near face, then straight on, refracted and reflected by the interfaces, across whole layers.
struct WayOut {
  std::size_t source = 0;
  bool starts_up = true;         ///< the near face is the layer's top
  bool ends_above = true;        ///< it leaves at the top of the stack
  double count = 1.0;            ///< ways that differ in their order of steps alone
  std::vector<int> crossings;    ///< [layer] of the whole layer
  std::vector<int> reflections;  ///< [interface]
  std::vector<int> passages;     ///< [interface]
};

/// Light of a normal pencil beam that is scattered once, over distance from the beam. Both the beam
/// and the scattered light have all their reflections; ways that would bring less than 1e-5 of the
/// layer's scattered light are left out.
///
/// The forward peak that the grid takes for no scattering weakens nothing here either, but the
/// angles are those of the whole phase function.
struct OnceScattered {
  GridStack stack;
  std::vector<PhaseFunction> phase;  ///< [layer]
  std::vector<double> sigma_s;       ///< [layer] the medium's own [1/mm]
  UnscatteredFlux beam;
  std::vector<WayOut> ways;
};
/// @param on_grid  the same stack, or its first layers, on a grid with the beam as its first extra
///                 node.
[[nodiscard]] OnceScattered make_once_scattered(const LayerStack& stack, GridStack on_grid);

/// At distance r [mm], > 0 [1/mm²].
struct SingleScatteringProfile {
  double reflectance = 0.0, transmittance = 0.0;
};
[[nodiscard]] SingleScatteringProfile single_scattering_profile(const OnceScattered& light,
                                                                double r);

/// The integral of that profile over the plane, as fractions of the beam's flux.
struct SingleScatteringTotals {
  double reflectance = 0.0, transmittance = 0.0;
};
[[nodiscard]] SingleScatteringTotals single_scattering_totals(const OnceScattered& light);

}  // namespace lamina::detail
