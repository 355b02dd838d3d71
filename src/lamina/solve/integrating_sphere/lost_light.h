// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/base/core/estimate.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Light that leaves a sample beside the ports that should collect it, as fractions of the light
/// that arrives.
struct LostLight {
  Estimate reflected, transmitted;
};

struct LostLightOptions {
  std::uint64_t photons = 1'000'000;
  std::uint64_t seed = 1;
  Progress progress;  ///< asked after every batch
};

/// Light that spreads in a sample, and in slides of glass around it, beyond round ports above and
/// below, by photons. The sample is wide: what travels in it to its rim is among what is lost.
///
/// @param beam_diameter  of an even beam in the middle of the ports [mm]; 0: a narrow one. Diffuse
///                       light falls on it likewise: that of a sphere fills the port.
/// @param port_diameter  [mm], > 0, at least that of the beam
/// @throws InvalidInput as trace_photons; Interrupted if progress asks to stop.
///
/// Source: [Prahl2011] §"Lost light", by another program of the same kind.
[[nodiscard]] LostLight lost_light(const LayerStack& stack, const Incidence& incidence,
                                   double beam_diameter, double port_diameter,
                                   const LostLightOptions& options = {});

}  // namespace lamina
