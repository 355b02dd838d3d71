// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "lamina/base/core/random.h"
#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/medium.h"
#include "solve/scattering/monte_carlo/scalar_photons.h"

namespace lamina::reference {

/// Fraction of the even light falling on a ball that enters, is scattered and leaves again:
/// a slow and literal Monte Carlo in double precision, one photon at a time, on the exact sphere.
/// It shares nothing with the renderer but Fresnel's formula. Seen from far away it is also the
/// radiance of the ball in light of radiance 1, mean over its disc, without what is mirrored.
///
/// @param medium  with isotropic scattering
[[nodiscard]] inline ScalarSum trace_ball_photons(const Medium& medium, double radius, int photons,
                                                  std::uint64_t seed) {
  assert(medium.g == 0.0);
  const double sigma_t = medium.sigma_a + medium.sigma_s, albedo = medium.sigma_s / sigma_t;
  Random random = make_random(seed, 0);
  ScalarSum leaving;
  for (int i = 0; i < photons; ++i) {
    // Even light meets a surface by Lambert's law. By symmetry it enters at the top.
    const double cos_i = std::sqrt(1.0 - random.uniform());
    const double sin_t = std::sqrt(1.0 - cos_i * cos_i) / medium.ior;
    double weight = 1.0 - fresnel(cos_i, medium.ior), left = 0.0;
    Vec3 position{0, 0, radius}, direction{sin_t, 0, -std::sqrt(1.0 - sin_t * sin_t)};
    while (weight > 0.0) {
      const double b = dot(position, direction);
      const double out =
          -b + std::sqrt(std::max(b * b - dot(position, position) + radius * radius, 0.0));
      const double path = -std::log(1.0 - random.uniform()) / sigma_t;
      position += std::min(path, out) * direction;
      if (path < out) {
        weight *= albedo;
        if (weight < 0.1) weight = random.uniform() < 0.5 ? 2.0 * weight : 0.0;  // roulette
        const double z = 1.0 - 2.0 * random.uniform(), r = std::sqrt(1.0 - z * z);
        const double phi = 2.0 * std::numbers::pi * random.uniform();
        direction = {r * std::cos(phi), r * std::sin(phi), z};
        continue;
      }
      const Vec3 normal = normalize(position);
      const double cos_t = std::min(dot(direction, normal), 1.0);
      if (!(random.uniform() < fresnel(cos_t, 1.0 / medium.ior))) {
        left = weight;
        break;
      }
      direction -= 2.0 * cos_t * normal;
      position = radius * normal;
    }
    leaving.add(left);
  }
  return leaving;
}

}  // namespace lamina::reference
