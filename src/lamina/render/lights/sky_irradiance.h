// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "lamina/layers/optics/rough/surface_boundary.h"
#include "lamina/render/lights/lights.h"

namespace lamina {

/// Whether it is of an environment.
[[nodiscard]] inline bool is_sky(const LightSample& light) {
  return !light.is_delta && light.distance == std::numeric_limits<float>::infinity();
}

/// Whether an environment is brighter in some directions, so that light samples are drawn from it.
[[nodiscard]] bool has_uneven_sky(const Lights& lights);

/// Calls on_light(LightSeen) for each environment, in a direction where nothing hides it.
template <class OnLight>
void for_sky_seen(const Lights& lights, const Vec3f& direction, const OnLight& on_light) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  lights.for_lights_seen({{}, direction}, 0.0f, infinity, false, [&](const LightSeen& seen) {
    if (seen.distance == infinity) on_light(seen);
  });
}

/// The irradiance of all environments of a scene that enters a surface, by its normal, where
/// nothing hides them: a control variate for light that is sampled. Known within about 10⁻³.
class SkyIrradiance {
 public:
  /// @param boundary  of the surface
  SkyIrradiance(const Lights& lights, const SurfaceBoundary& boundary);

  /// Irradiance inside per radiance from a direction: its cosine times the fraction that passes the
  /// boundary.
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
