// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Profiles of a half-space and of slabs of its layers in diffuse light, per arriving flux.
struct ThicknessProfiles {
  Profile half_space;
  std::vector<Profile> slabs;     ///< [slab], ever thicker, see make_slab
  std::vector<double> thickness;  ///< [slab] of all its layers [mm]
};

struct ThicknessRange {
  double thinnest = 0.05;   ///< slab [mm], thicker than its outer layers
  double thickest = 200.0;  ///< slab [mm]; all are thinner
  /// Share of diffuse light: the first slab that lets less through in every band is the last, and
  /// none is made if it is the thinnest.
  double least_transmittance = 2e-3;
};

/// Whether `thickness_profiles` takes these half-spaces, [band]: smooth, with layers that all
/// scatter.
[[nodiscard]] bool takes_thickness_profiles(std::span<const LayerStack> half_spaces);

/// Solves a half-space and slabs of it together, by radiative transfer on one grid of directions
/// and frequencies, without refinement. From slab to slab the inner layer is thicker by sqrt(2).
///
/// Against `transfer_profile` of each alone, in the mean, weighted by flux: half-spaces within .1
/// %. Slabs, R within .3 % from 3 mean free paths on, 2 % of thinner ones; T within 1 % from 7 mean
/// free paths on, 2 % from 3 on if g is .8, 4 % of skin of .3 mm, .2 % if scattering is isotropic
/// (test). Slabs of a tenth of a mean free path are wrong by 2 to 7 %, by either solver.
///
/// @param half_spaces  [band], see takes_thickness_profiles
/// @throws Interrupted if progress asks to stop
///
/// Source: doubling of layers, [vandeHulst1980] 4.2, for each spatial frequency; see
/// docs/radiative_transfer_profiles.md.
[[nodiscard]] ThicknessProfiles thickness_profiles(std::span<const LayerStack> half_spaces,
                                                   const ThicknessRange& range,
                                                   const RadialGrid& radii = {},
                                                   const Progress& progress = {});

}  // namespace lamina
