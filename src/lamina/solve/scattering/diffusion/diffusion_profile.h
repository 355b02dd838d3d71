// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Profiles by layered diffusion, per entered flux, and how far they can be trusted.
struct DiffusionProfile {
  Profile profile;
  std::vector<std::vector<std::size_t>> thin_layers;  ///< [band], see `thin_layers`
  /// Flux by which the model's profiles are negative, which are set to 0 there, [band]. It is 0 but
  /// for layers a mean free path thick under a strongly reflecting surface.
  std::vector<double> clamped_reflectance, clamped_transmittance;
};

/// R(r) and T(r) of a layered material, one stack per band.
///
/// Against a converged quadrature the error is below 1e-6 relative wherever a profile exceeds 1e-8
/// of its peak. Below some 1e-11 of the peak rounding takes over, and the profile is drawn on as a
/// decaying exponential. The totals are the model's, with what lies beyond the grid; light that
/// leaves where it entered (`local_response`) is in them and not in the profile.
///
/// @param stacks  [band], at least one.
/// @throws InvalidInput naming the band and the layer that does not scatter, or a wrong grid.
[[nodiscard]] DiffusionProfile make_diffusion_profile(std::span<const LayerStack> stacks,
                                                      const DiffusionOptions& options = {},
                                                      const RadialGrid& grid = {});

/// Makes a profile on the grid of a plan, which is made once for many materials.
[[nodiscard]] DiffusionProfile make_diffusion_profile(std::span<const LayerStack> stacks,
                                                      const HankelPlan& plan,
                                                      const DiffusionOptions& options = {});

}  // namespace lamina
