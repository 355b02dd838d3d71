// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// A homogeneous scattering and absorbing material at one wavelength.
struct Medium {
  double sigma_a = 0.0;  ///< absorption coefficient [1/mm], >= 0
  double sigma_s = 0.0;  ///< scattering coefficient [1/mm], >= 0
  double g = 0.0;        ///< mean cosine of the scattering angle, in (-1, 1)
  double ior = 1.0;      ///< refractive index relative to vacuum, > 0
};

/// Extinction coefficient [1/mm].
[[nodiscard]] inline double sigma_t(const Medium& m) { return m.sigma_a + m.sigma_s; }

/// Probability that an event scatters, in [0, 1]; 0 in a clear medium.
[[nodiscard]] inline double albedo(const Medium& m) {
  return m.sigma_s > 0.0 ? m.sigma_s / sigma_t(m) : 0.0;
}

/// Reduced scattering coefficient [1/mm].
[[nodiscard]] inline double sigma_s_prime(const Medium& m) { return m.sigma_s * (1.0 - m.g); }

/// Reduced extinction coefficient [1/mm].
[[nodiscard]] inline double sigma_t_prime(const Medium& m) { return m.sigma_a + sigma_s_prime(m); }

/// Reduced albedo, in [0, 1]; 0 in a clear medium.
[[nodiscard]] inline double albedo_prime(const Medium& m) {
  return m.sigma_s > 0.0 ? sigma_s_prime(m) / sigma_t_prime(m) : 0.0;
}

/// Mean free path and its reduced form [mm]; infinite in a clear medium.
[[nodiscard]] inline double mfp(const Medium& m) { return 1.0 / sigma_t(m); }
[[nodiscard]] inline double mfp_prime(const Medium& m) { return 1.0 / sigma_t_prime(m); }

/// Effective transport coefficient [1/mm]: diffuse light decays as exp(-sigma_tr * distance).
[[nodiscard]] inline double sigma_tr(const Medium& m) {
  return std::sqrt(3.0 * m.sigma_a * sigma_t_prime(m));
}

}  // namespace lamina
