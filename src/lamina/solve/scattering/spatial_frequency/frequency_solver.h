// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/spatial_frequency/azimuth_chain.h"
#include "lamina/solve/scattering/spatial_frequency/top_passage.h"

namespace lamina::detail {

/// A stack on a direction grid for one pencil beam at normal incidence, with the kernels of all
/// azimuthal modes 0 .. modes: what does not depend on spatial frequency.
///
/// At spatial frequency k the radiance is the sum over m of (-i)^m c_m f_m cos(m phi), c_0 = 1,
/// else sqrt(2), phi measured from the wave. Streaming, i k sin(theta) cos(phi), then couples
/// neighbouring modes by real numbers. A state is a mode at a node; the beam has mode 0 only.
struct FrequencySolver {
  GridStack stack;
  int modes = 5;  ///< highest mode
  AzimuthChain azimuth;
  AzimuthWaves waves;
  std::vector<std::vector<PhaseMode>> phase;  ///< [layer][mode]
  std::vector<RoughBoundaries> rough;         ///< [mode]
  TopPassage top;
};

/// Rough boundaries that a solver has. A boundary is local, so that it is the same at every
/// frequency; it takes a tenth of a second.
enum class RoughModes {
  all,
  first  ///< of azimuthal mode 0: for straight rays, not for responses
};

/// @param oblique       further directions that beams come from, as extra nodes after the normal
///                      one; the boundaries must be smooth then.
/// @param illumination  of a rough top's passage.
[[nodiscard]] FrequencySolver make_frequency_solver(
    const LayerStack& stack, int nodes, int modes, std::span<const GridDirection> oblique = {},
    Illumination illumination = Illumination::diffuse, RoughModes rough = RoughModes::all);

}  // namespace lamina::detail
