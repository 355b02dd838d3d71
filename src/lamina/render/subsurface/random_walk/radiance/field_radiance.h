// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"

namespace lamina {

/// Estimate of the radiance at a point, made beforehand: what a path may expect to find at a
/// scattering event there. Means, with how far single estimates are from them.
template <int N>
struct FieldRadiance {
  BandValues<N> direct_fluence;   ///< of light that comes straight from lights
  BandValues<N> scattered;        ///< mean radiance of all other light
  Vec3f to_light;                 ///< mean direction towards the lights, length at most 1
  float deviation = 0.0f;         ///< root mean square of that of `scattered`
  float direct_deviation = 0.0f;  ///< of `direct_fluence`, at most
  /// The P1 moment: radiance from a direction w is `scattered` + (`net_flux` · w) `directed`,
  /// about.
  Vec3f net_flux;
  BandValues<N> directed;

  /// Whether `scattered` is known.
  [[nodiscard]] bool is_solved() const { return deviation > 0.0f; }
  /// Scattered radiance per sigma_s that a path which goes on in a direction may expect.
  [[nodiscard]] BandValues<N> along(const Vec3f& direction) const {
    return scattered + dot(net_flux, direction) * directed;
  }
  /// Mean for a path that comes in a direction and scatters by a phase function.
  [[nodiscard]] BandValues<N> mean(const Vec3f& incoming, const BandValues<N>& mean_cosine) const {
    return scattered + dot(net_flux, incoming) * mean_cosine * directed;
  }
};

}  // namespace lamina
