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
///
/// For fits whose totals are printed to five digits, of any index and mean cosine. HalfSpaceColor
/// answers the same question from its table in microseconds, within .1 % and for what a
/// HalfSpaceLook may be.
[[nodiscard]] HalfSpaceAlbedo half_space_albedo(double reflectance, double g, double ior,
                                                double ior_above);

}  // namespace lamina
