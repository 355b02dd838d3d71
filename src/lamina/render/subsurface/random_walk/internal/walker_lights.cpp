// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How a random walk finds light: next-event estimation, paths that leave, and their MIS weights.
#include <cmath>
#include <functional>

#include "lamina/optics/henyey_greenstein.h"
#include "lamina/render/subsurface/random_walk/internal/walker.h"

namespace lamina {

/// By the power heuristic, for densities over directions at the event: where a curved boundary
/// focuses light, paths find it more easily.
///
/// @param scattered  of `scattered_along`
/// @param pdf        of next-event estimation [1/sr]; infinite for what no path meets
template <int N>
float Walker<N>::mis_weight(const Bands& scattered, float pdf) const {
  if (!std::isfinite(pdf)) return 1.0f;
  return power_heuristic(path_.last.next_event_rate * pdf, density_of_paths(scattered));
}

template <int N>
float Walker<N>::density_of_paths(const Bands& scattered) const {
  const Bands leaving = scattered * path_.last.throughput;
  const int bands = last_place_.medium->layers.bands();
  float of_paths = 0.0f, throughput = 0.0f;
  for (int b = 0; b < bands; ++b) {
    of_paths += leaving[b];
    throughput += path_.last.throughput[b];
  }
  return of_paths * path_.last.continuation / throughput;
}

template <int N>
BandValues<N> Walker<N>::scattered_along(const Vec3f& direction, float length) const {
  const Ray& last = path_.last.ray;
  return exp_minus(media_.optical_thickness({last.origin, direction}, last_place_, length)) *
         last_place_.medium->layers.phase(last_place_.depth,
                                          one_minus_cos(direction, last.direction));
}

template <int N>
BandValues<N> Walker<N>::sample_direct_light() {
  const BodyMedium<N>& medium = *last_place_.medium;
  const Vec3f& origin = path_.last.ray.origin;
  const auto find = [&](const Vec3f& direction) {
    return media_.find_boundary({origin, direction}, last_place_);
  };
  const FindBoundary find_boundary = std::cref(find);
  Random& random = numbers_.stream();
  Bands found;
  const float u_light = random.uniform_float(), u = random.uniform_float();
  medium.next_event.sample_light(
      origin, u_light, {u, random.uniform_float()}, light_,
      [&](const RefractedLight<N>& sample) {
        const Vec3f& direction = sample.entry.to_surface;
        const float length = sample.entry.length;
        const Bands scattered = scattered_along(direction, length);
        const Bands residual =
            media_.sample_residual({origin, direction}, last_place_, length, random);
        // Over centimetres from a dark place of a map one underflows, and the other overflows.
        Bands arriving;
        for (int b = 0; b < N; ++b)
          if (scattered[b] > 0.0f) arriving[b] = scattered[b] * residual[b];
        found += mis_weight(sample.entry.reflectance * scattered, sample.pdf) * arriving *
                 sample.unattenuated;
      },
      medium.has_neighbors ? &find_boundary : nullptr);
  return found;
}

template <int N>
BandValues<N> Walker<N>::escaping_radiance(const WalkPath<N>& path, const WalkExit& exit) {
  const BodyMedium<N>& medium = *last_place_.medium;
  const Vec3f& origin = path.last.ray.origin;
  const auto find = [&](const Vec3f& direction) {
    return media_.find_boundary({origin, direction}, last_place_);
  };
  const FindBoundary find_boundary = std::cref(find);
  return medium.next_event.escaping_radiance(
      path, exit, light_, samples_,
      [&](const RefractedEntry& entry, float pdf) {
        return mis_weight(entry.reflectance * scattered_along(entry.to_surface, entry.length), pdf);
      },
      medium.has_neighbors ? &find_boundary : nullptr);
}

#define LAMINA_INSTANTIATE(N)                                                               \
  template BandValues<N> Walker<N>::sample_direct_light();                                  \
  template BandValues<N> Walker<N>::escaping_radiance(const WalkPath<N>&, const WalkExit&); \
  template float Walker<N>::density_of_paths(const BandValues<N>&) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
