// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lamina/optics/rough/surface_boundary.h"
#include "lamina/render/lights/lights.h"

namespace lamina {

/// The irradiance of all environments of a scene that enters a surface, by its normal, where
/// nothing hides them: a control variate for light that is sampled. Known within about 10⁻³.
class SkyIrradiance {
 public:
  /// @param boundary  of the surface
  SkyIrradiance(const Lights& lights, const SurfaceBoundary& boundary);

  /// What light from a direction gives: its cosine times the fraction that passes the boundary.
  /// @param cos_i  in [0, 1]
  [[nodiscard]] float entering(float cos_i) const;

  /// The integral of that times the radiance. @param normal  of unit length
  [[nodiscard]] Vec3f at(const Vec3f& normal) const;

 private:
  static constexpr int cosines = 64, side = 48;

  std::array<float, cosines + 1> passing_{};  ///< at the cosines i / cosines
  std::vector<Vec3f> irradiance_;             ///< [y][x], over the octahedron
};

}  // namespace lamina
