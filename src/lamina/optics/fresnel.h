// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cmath>

namespace lamina {

/// Unpolarized reflectance of a smooth interface between two dielectrics.
///
/// @param cos_i  cosine of the angle of incidence, in [0, 1].
/// @param eta    refractive index beyond the interface over that before it, > 0.
/// @return       reflected fraction of the flux: 1 under total internal reflection, 0 if eta = 1.
///
/// Source: [BornWolf1999] §1.5.2, Eq. 21, averaged over the two polarizations.
[[nodiscard]] inline double fresnel(double cos_i, double eta) {
  assert(0.0 <= cos_i && cos_i <= 1.0 && eta > 0.0);
  if (eta == 1.0) return 0.0;
  const double sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);  // Snell's law
  if (sin2_t >= 1.0) return 1.0;
  const double cos_t = std::sqrt(1.0 - sin2_t);
  const double r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const double r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return 0.5 * (r_s * r_s + r_p * r_p);
}

}  // namespace lamina
