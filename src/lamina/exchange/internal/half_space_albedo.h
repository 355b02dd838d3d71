// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lamina {

struct HalfSpaceAlbedo {
  double albedo_prime = 0.0;  ///< reduced
  double reflectance = 0.0;   ///< that it has
  bool is_met = false;        ///< that is the one wanted, within 1e-5
};

/// The reduced albedo of a half-space that returns the wanted fraction of diffuse light, its first
/// reflection left out, by adding-doubling.
[[nodiscard]] HalfSpaceAlbedo half_space_albedo(double reflectance, double g, double ior,
                                                double ior_above);

}  // namespace lamina
