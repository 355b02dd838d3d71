// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/exchange/medium_fit/channel_light.h"

namespace lamina::detail {

/// Burley's normalized profile, A (exp(-r/d) + exp(-r/(3d))) / (8 pi d r), which screen-space and
/// disk-based subsurface scattering have: the lengths whose profiles are nearest to those of a
/// material.
struct BurleyProfiles {
  std::vector<double> d;  ///< [channel] [mm]
  Profile profile;        ///< at the radii of the light, with its totals
};

/// Least in profile_difference, of the light that is reflected.
///
/// Source: [ChristensenBurley2015] Eq. 3.
[[nodiscard]] BurleyProfiles fit_burley(const ChannelLight& light);

/// Factor by which such shaders multiply d to have the mean free path: s of a perpendicular beam.
///
/// @param color  diffuse, in [0, 1]
/// Source: [ChristensenBurley2015] Eq. 5.
[[nodiscard]] double burley_mean_free_path_scale(double color);

}  // namespace lamina::detail
