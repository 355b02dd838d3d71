// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace lamina {

/// How light arrives on the top of a stack.
struct Incidence {
  bool is_diffuse = false;  ///< equal radiance from the whole hemisphere
  double theta = 0.0;       ///< else the angle from the normal outside [rad], in [0, pi/2)
};

/// Totals of the light that arrives on a stack, as fractions of it; one wavelength.
/// The four kinds sum to 1, but for light that a ground absorbs.
struct SlabTotals {
  double specular_reflectance = 0.0;  ///< the first reflection at the top surface only
  double diffuse_reflectance = 0.0;   ///< everything else that leaves at the top
  double transmittance = 0.0;         ///< what leaves at the bottom, unscattered light included
  std::vector<double> absorptance;    ///< [layer]
};

}  // namespace lamina
