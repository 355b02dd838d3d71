// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

namespace lamina::detail {

/// Azimuthal modes 0 .. M of light under a wave of frequency k: streaming over a depth z couples
/// each to its neighbours by c = k z tan(theta) times the numbers here,
///
///     df_m / dc = coupling[m - 1] f_(m-1) - coupling[m] f_(m+1),
///
/// so that with all modes f_0 = J0(c). Cut off at M, light would be reflected back to mode 0 and
/// return as J0 does not. Here the chain's end takes up what arrives: the last mode is damped, and
/// its couplings are such that hardly anything is reflected.
///
/// Light of direction theta weakens by exp(-sigma_t c / (k sin(theta))). So weighted, the modes 0
/// to 2 are right to 5e-3, 8e-4, 2e-4 of 1 with M = 3, 5, 7 for k sin(theta) = 4 sigma_t; without
/// the absorbing end to .07, .02, .007.
struct AzimuthChain {
  std::vector<double> coupling;  ///< [m] between m and m + 1
  double damping = 0.0;          ///< of mode M
};
enum class AzimuthEnd {
  absorbing,
  cut_off  ///< M odd: as many azimuths as modes, cos((q + 1/2) pi / (M + 1))
};
/// @param modes  M, >= 1.
[[nodiscard]] AzimuthChain make_azimuth_chain(int modes, AzimuthEnd end = AzimuthEnd::absorbing);

/// Azimuth chain as independent waves: light that starts in mode 0 is, in mode m, after c,
/// sum over q of Re(weight[m][q] exp(rate[q] c)). From mode m to mode 0: (-1)^m times that.
struct AzimuthWaves {
  std::vector<std::complex<double>> rate;                 ///< [wave], real parts < 0
  std::vector<std::vector<std::complex<double>>> weight;  ///< [mode][wave]
};
[[nodiscard]] AzimuthWaves azimuth_waves(const AzimuthChain& chain);

}  // namespace lamina::detail
