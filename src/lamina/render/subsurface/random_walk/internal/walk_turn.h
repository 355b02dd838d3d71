// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "lamina/core/vec.h"
#include "lamina/optics/phase_function.h"
#include "lamina/render/subsurface/random_walk/internal/body_interior.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// Turns a path where it scatters, by the phase function of a band, each drawn in proportion to
/// what it carries. All bands count by the density of the mixture.
///
/// @param phases         [band]
/// @param is_same_phase  in all bands
/// @param phase          (1 - cos of the turn) to the phase functions of all bands
template <int N, class Phase>
void turn_at_event(WalkPath<N>& path, const std::vector<PhaseFunction>& phases, bool is_same_phase,
                   WalkNumbers& numbers, const Phase& phase) {
  const auto bands = static_cast<int>(phases.size());
  const Vec2f u = numbers.pair();
  const int drawn =
      is_same_phase ? 0 : draw_band(path.carried, bands, numbers.stream().uniform_float());
  const double cosine = sample_cos_theta(phases[static_cast<std::size_t>(drawn)],
                                         static_cast<double>(u.x), numbers.stream().uniform());
  const auto cos_theta = static_cast<float>(cosine),
             one_minus_cos = static_cast<float>(1.0 - cosine);
  const float sin_theta = std::sqrt(one_minus_cos * (1.0f + cos_theta));
  const float phi = 2.0f * std::numbers::pi_v<float> * u.y;
  const Framef frame = make_frame(path.ray.direction);
  path.ray.direction =
      normalize(frame.to_world({sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta}));
  if (is_same_phase) return;
  const BandValues<N> carried = path.carried * phase(one_minus_cos);
  float before = 0.0f, density = 0.0f;
  for (int b = 0; b < bands; ++b) {
    before += path.carried[b];
    density += carried[b];
  }
  path.carried = (before / density) * carried;
}

}  // namespace lamina
