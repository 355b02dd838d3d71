// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How a random walk finds light: next-event estimation, paths that leave, and their MIS weights.
#include <cmath>
#include <functional>

#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/render/subsurface/random_walk/internal/walker.h"

namespace lamina {
namespace {

constexpr float least_worth = 0.05f;  // of direct light, over what a path finds in all

}  // namespace

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
  const int events = path_.events;
  return exp_minus(
             media_.optical_thickness({last.origin, direction}, last_place_, length, events)) *
         last_place_.medium->layers_at(events).phase(last_place_.depth,
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
        // The way through maps takes long: for little light by Russian roulette.
        const float worth = media_.has_maps()
                                ? largest(path_.throughput * scattered * sample.unattenuated) /
                                      (least_worth * std::max(reference_, least_reference_))
                                : 1.0f;
        if (worth < 1.0f && !(random.uniform_float() < worth)) return;
        const Bands residual =
            std::max(1.0f / worth, 1.0f) *
            media_.sample_residual({origin, direction}, last_place_, length, path_.events, random);
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
      [&](const LightSeen& seen) { return weight_against_vertices(path, exit, seen); },
      medium.has_neighbors ? &find_boundary : nullptr);
}

template <int N>
BandValues<N> Walker<N>::sample_light_vertex() {
  const BodyMedium<N>& medium = *place_.medium;
  const LightVertices<N>& vertices = *medium.light_vertices;
  const Vec3f &origin = path_.ray.origin, &direction = path_.ray.direction;
  Random& random = numbers_.stream();
  const float u = random.uniform_float();
  const auto chosen = vertices.choose(origin, {u, random.uniform_float()});
  if (!chosen) return {};
  const auto& [position, to_light, power, density] = chosen->vertex;
  const Vec3f offset = position - origin;
  const float distance = length(offset);
  if (!(distance > least_distance(media_.scene()))) return {};
  const Vec3f onward = offset / distance;
  if (media_.scene().geometry.is_blocked({origin, onward}, 0.0f, distance)) return {};
  const auto phase = [&](const Vec3f& a, const Vec3f& b) {
    return medium.layers.phase(place_.depth, one_minus_cos(a, b));
  };
  const Bands here = phase(direction, onward), there = phase(onward, to_light);
  const float weight =
      vertices.weight({origin, position, largest(here) * largest(there), density}, chosen->others);
  return (weight / (chosen->probability * distance * distance)) * here * there *
         exp_minus(distance * medium.layers.medium(0).sigma_t) * power;
}

template <int N>
float Walker<N>::weight_against_vertices(const WalkPath<N>& path, const WalkExit& exit,
                                         const LightSeen& seen) const {
  const LightVertices<N>* vertices = last_place_.medium->light_vertices.get();
  const auto& last = path.last;
  if (!vertices || vertices->is_empty()) return 1.0f;
  const bool is_shared = path.events > 1 && last.is_straight && !path.is_reflected_diffusely;
  if (!is_shared) return 1.0f;
  const float density = vertices->density_of_light(exit.point, exit.outside, seen.pdf);
  const Bands phase = last_place_.medium->layers.phase(
      last_place_.depth, one_minus_cos(last.ray.direction, last.turned));
  return vertices->weight_of_path(
      {last.before, last.ray.origin, last.phase_before * largest(phase), density});
}

#define LAMINA_INSTANTIATE(N)                                                               \
  template BandValues<N> Walker<N>::sample_direct_light();                                  \
  template BandValues<N> Walker<N>::escaping_radiance(const WalkPath<N>&, const WalkExit&); \
  template float Walker<N>::density_of_paths(const BandValues<N>&) const;                   \
  template BandValues<N> Walker<N>::sample_light_vertex();                                  \
  template float Walker<N>::weight_against_vertices(const WalkPath<N>&, const WalkExit&,    \
                                                    const LightSeen&) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
