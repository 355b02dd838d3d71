// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "lamina/core/vec.h"
#include "lamina/scattering/profile/profile.h"

namespace lamina {

/// Shares of the two profiles of a layered material on a curved object.
struct ThinGeometryBlend {
  double reflectance;    ///< in [0, 1]
  double transmittance;  ///< the remainder
};

/// Blend by the normals where light enters and leaves: all reflection where they agree, all
/// transmission where they oppose, as on the two sides of an ear.
///
/// @param cos_normals  dot product of the two unit normals, in [-1, 1].
///
/// It knows the normals and not the distance between the sides: right for flat slabs, a guess
/// between. Source: [DonnerJensen2005] Eq. 27.
[[nodiscard]] inline ThinGeometryBlend thin_geometry_blend(double cos_normals) {
  const double reflectance = std::clamp(0.5 * (1.0 + cos_normals), 0.0, 1.0);
  return {reflectance, 1.0 - reflectance};
}
[[nodiscard]] inline ThinGeometryBlend thin_geometry_blend(const Vec3& normal_in,
                                                           const Vec3& normal_out) {
  return thin_geometry_blend(dot(normal_in, normal_out));
}

/// The blended profile P_d at distance r > 0 [mm] [1/mm²]. Source: [DonnerJensen2005] Eq. 27.
[[nodiscard]] inline double blended_profile(const Profile& profile, double r, std::size_t band,
                                            const ThinGeometryBlend& blend) {
  return blend.reflectance * reflectance_profile(profile, r, band) +
         blend.transmittance * transmittance_profile(profile, r, band);
}

}  // namespace lamina
