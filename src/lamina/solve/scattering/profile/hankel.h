// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// Radii in a geometric series.
struct RadialGrid {
  double first = 1e-3;     ///< [mm], > 0
  double last = 1e2;       ///< [mm], > first
  std::size_t size = 256;  ///< >= 2
};

/// The radii of a grid [mm], ascending.
/// @throws InvalidInput if the grid has less than two radii, or they are not > 0 and ascending.
[[nodiscard]] std::vector<double> radii(const RadialGrid& grid);

/// The way from profiles over spatial frequency k [1/mm] to profiles over radius r [mm]:
///
///     profile(r) = 1 / (2 pi) * integral of spectrum(k) J0(k r) k dk over k from 0 to infinity.
///
/// Both are sampled in geometric series. A spectrum of diffused light is smooth in log k at every
/// scale, so that it holds no oscillations over log k faster than some 40 per unit; of J0, those
/// that are faster meet nothing. The kernel, freed of them, is short: a few hundred samples give
/// ten digits over all scales at once, where quadrature between the zeros of J0 takes 1e5.
///
/// Error relative to a profile's peak: below 1e-14, for radii from a thousandth of the spectrum's
/// length scale on; 1e-8 relative where the profile has fallen to 1e-8 of its peak. The spectrum
/// must be even and analytic in k near the real axis (poles and cuts on the imaginary axis, as
/// diffusion has them), or have finitely many slopes at k = 0 as without absorption.
///
/// Source: the logarithmic grid is [Talman1978]'s, the finite kernel that of digital linear filters
/// [Anderson1979]; here its band limit is soft, so that it ends after some 300 samples.
struct HankelPlan {
  std::vector<double> k;       ///< spatial frequencies at which the spectrum is asked for [1/mm]
  std::vector<double> r;       ///< radii of the result [mm]
  std::vector<double> kernel;  ///< band-limited k r J0(k r) over a fine geometric series in k r
  std::size_t k_stride;        ///< steps of that series between frequencies
  std::size_t r_stride;        ///< and between radii
  double k_step;               ///< log of the ratio of frequencies
};

/// @throws InvalidInput as `radii`.
[[nodiscard]] HankelPlan make_hankel_plan(const RadialGrid& grid);

/// Profiles of several spectra at once.
///
/// @param spectra  [k, channel], of size plan.k.size() * channels.
/// @return         [r, channel] [1/mm²].
[[nodiscard]] std::vector<double> inverse_hankel(const HankelPlan& plan,
                                                 std::span<const double> spectra,
                                                 std::size_t channels);

}  // namespace lamina
