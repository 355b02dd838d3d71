// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/base/core/progress.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/profile/hankel.h"

namespace lamina {

/// R and T of a pencil beam that falls on obliquely, over the plane around the point where it comes
/// in: moments in azimuth,
///
///     R(r, phi) = sum over m of R_m(r) cos(m phi),
///
/// phi from the direction in which the beam goes on. R_0 is the mean over rings.
struct ObliqueProfile {
  std::size_t bands = 0, moments = 0;
  std::vector<double> r;                    ///< [i] [mm]
  std::vector<double> reflectance_moments;  ///< [i][m][band] [1/mm²], per arriving flux
  std::vector<double> transmittance_moments;
  std::vector<double> total_reflectance, total_transmittance;  ///< [band], as in Profile
  std::vector<double> estimated_error;      ///< [i][band], of R_0, relative, at most 1
  std::vector<double> transmittance_error;  ///< [i][band], of T_0
  /// [band], the largest of both from .01 to 6 mm where there is light; infinite where a value is
  /// negative.
  std::vector<double> largest_error;
  std::vector<double> mean_error;  ///< [band], of the side where it is larger, weighted by flux
};

/// By radiative transfer, as `transfer_profile`, with eight azimuthal modes: light scattered once
/// by the slanted beam is put in exactly at each point, the rest is solved over frequency.
///
/// @param theta    [rad], in [0, pi/2), above the stack.
/// @param moments  in [1, 32]; beyond 8 only light scattered once has them.
/// @throws InvalidInput as `transfer_profile`, or if theta is out of range; Interrupted.
[[nodiscard]] ObliqueProfile oblique_profile(std::span<const LayerStack> stacks, double theta,
                                             const RadialGrid& radii = {}, int moments = 8,
                                             const Progress& progress = {});

/// R at a point, from the moments.
[[nodiscard]] double reflectance_at(const ObliqueProfile& profile, std::size_t i, double phi,
                                    std::size_t band);

}  // namespace lamina
