// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/monte_carlo/photon_tallies.h"

namespace lamina::photon {

/// One direction outside as seen from inside: how much of the light that an event sends along it
/// leaves there without another event, whatever it is reflected by boundaries on its way.
struct ExitView {
  // [layer]; all 0 where light of the direction cannot be.
  std::vector<float> ux, uy;       ///< horizontal part of the direction inside
  std::vector<float> mu;           ///< cosine from the normal inside
  std::vector<float> from_top;     ///< of light going up just below the layer's upper boundary, [1]
                                   ///< times the ratio of radiance outside to intensity inside
  std::vector<float> from_bottom;  ///< of light going down just above the lower boundary
  std::vector<float> decay;        ///< sigma_t / mu [1/mm]
  float from_ground = 0.0f;        ///< of light that a Lambertian ground sends out
};

/// @throws InvalidInput if a boundary is rough, or a direction below a reflecting ground.
[[nodiscard]] ExitView make_exit_view(const LayerStack& stack, const ExitDirection& direction);

}  // namespace lamina::photon
