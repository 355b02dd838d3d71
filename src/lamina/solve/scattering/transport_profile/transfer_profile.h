// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/profile.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"

namespace lamina {

/// Error that an accuracy is asked of.
enum class ProfileError {
  largest,  ///< at each radius where there is light, on either side
  mean      ///< weighted by flux, over all radii and both sides together: what a picture is wrong
            ///< by, in a fraction of the time
};

struct TransferProfileOptions {
  double accuracy =
      0.005;  ///< asked of the profile, relative, in [1e-4, 0.1], where there is light: see below
  ProfileError error = ProfileError::largest;
  double r_lowest = 0.01;  ///< the accuracy is asked from this radius on [mm]
  double r_highest = 6.0;  ///< and up to this one [mm]
  Illumination illumination = Illumination::normal_beam;
  bool is_from_below = false;  ///< lit on the lower side, which reflectance then means, too
  Progress progress = {};      ///< told that the work goes on, not how far it is
};

/// A profile by radiative transfer, with an estimate of its error.
struct TransferProfile {
  Profile profile;                          ///< per arriving flux
  std::vector<double> relative_error;       ///< [i][band], estimated, of the reflectance profile
  std::vector<double> transmittance_error;  ///< [i][band], the same of the transmittance profile
  std::vector<double> estimated_error;      ///< [band], largest within the radii asked
  std::vector<double> mean_error;           ///< [band], weighted by flux, relative
  std::vector<int> nodes, modes;            ///< [band], of the last solution
  std::vector<std::uint64_t> photons;       ///< [band] that took part, 0 if none
  bool is_accurate = false;                 ///< every estimate is within the accuracy asked
};

/// R(r) and T(r) of a layered material around a point of light by the equation of radiative
/// transfer, one spatial frequency at a time; no diffusion, no noise.
///
/// Light scattered once is taken out at every frequency and put in exactly over radius. Directions,
/// azimuthal modes and frequencies grow until a further step changes less than asked, wherever a
/// ring of the profile holds more than 1e-4 of the flux in the fullest ring of equal relative
/// width. Light of a beam that leaves unscattered is in the totals and not in the profile. Diffuse
/// light spreads without being scattered: it is in both, and only what the lit surface mirrors is
/// left out of R(r).
///
/// Diffuse light with all that leaves collected is what a renderer with a Fresnel factor at the
/// entry and one at the exit needs: see docs/radiative_transfer_profiles.md.
///
/// @param stacks  [band], at least one; every band must scatter.
///
/// Boundaries may be rough. What a rough top throws back by itself is not in R(r), as a smooth
/// top's mirror light is not; what a rough bottom lets out where a beam arrives unscattered is not
/// in T(r). Both leave at r = 0, and are in the totals.
///
/// Where waves do not reach the accuracy, photons refine the profile; the top must be smooth.
///
/// @throws InvalidInput naming a wrong grid, a stack without a lower side, or under a rough top a
/// plate that neither scatters nor absorbs nine tenths.
/// @throws Interrupted if progress asks to stop.
///
/// Source: docs/radiative_transfer_profiles.md.
[[nodiscard]] TransferProfile transfer_profile(std::span<const LayerStack> stacks,
                                               const RadialGrid& radii = {},
                                               const TransferProfileOptions& options = {});

/// Checks that `transfer_profile` takes these stacks, before any work.
/// @throws InvalidInput as it.
void require_transfer_profile(std::span<const LayerStack> stacks,
                              const TransferProfileOptions& options = {});

/// Stacks with above and below exchanged.
/// @throws InvalidInput if a stack has no lower side, or a ground that reflects.
[[nodiscard]] std::vector<LayerStack> lit_from_below(std::span<const LayerStack> stacks);

}  // namespace lamina
