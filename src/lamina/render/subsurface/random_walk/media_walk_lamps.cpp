// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How MediaWalk finds the light of lamps and of what else is outside.
#include <cmath>
#include <functional>
#include <limits>

#include "lamina/optics/henyey_greenstein.h"
#include "lamina/render/subsurface/random_walk/media_walk.h"

namespace lamina {
namespace {

/// Source: [VeachGuibas1995].
[[nodiscard]] float power_heuristic(float own, float other) {
  return own > 0.0f ? 1.0f / (1.0f + (other / own) * (other / own)) : 0.0f;
}

/// Of the two that find the same light of a lamp, a search and paths that leave, for densities over
/// directions at the event.
///
/// @param leaving  what each band carries, weakened on the way out and turned by the phase function
/// @param pdf      with which a search draws the way [1/sr]; infinite for what no path meets
template <int N>
float weight_of_search(const typename WalkPath<N>::Event& event, const BandValues<N>& leaving,
                       float pdf, int bands) {
  if (!std::isfinite(pdf)) return 1.0f;
  float rival = 0.0f, carried = 0.0f;
  for (int b = 0; b < bands; ++b) {
    rival += leaving[b];
    carried += event.carried[b];
  }
  rival *= event.going / carried;
  return power_heuristic(event.searching * pdf, rival);
}

}  // namespace

template <int N>
BandValues<N> MediaWalk<N>::search(const WalkPath<N>& path, const Place& place,
                                   const LightGatherer<N>& light, Random& random) const {
  const BodyMedium<N>& medium = *place.medium;
  const Vec3f& origin = path.ray.origin;
  const auto find = [&](const Vec3f& direction) {
    return media_->find_boundary({origin, direction}, place);
  };
  const FindBoundary find_boundary = std::cref(find);
  Bands found;
  const float u_light = random.uniform_float(), u = random.uniform_float();
  medium.lamps.search(
      origin, u_light, {u, random.uniform_float()}, light,
      [&](const FoundLamp<N>& lamp) {
        const Vec3f& direction = lamp.entry.to_surface;
        const Bands turned =
            exp_minus(media_->optical_thickness({origin, direction}, place, lamp.entry.length)) *
            medium.layers.phase(place.depth.layer, one_minus_cos(direction, path.ray.direction));
        found += weight_of_search(path.last, turned * path.last.carried, lamp.pdf,
                                  medium.layers.bands()) *
                 turned * lamp.unweakened;
      },
      medium.has_neighbors ? &find_boundary : nullptr);
  return found;
}

template <int N>
BandValues<N> MediaWalk<N>::light_outside(const WalkPath<N>& path, const Place& last,
                                          const BoundaryTurn& turn, const SurfacePoint& point,
                                          const LightGatherer<N>& light,
                                          PixelSamples& samples) const {
  const BodyMedium<N>& medium = *last.medium;
  const Ray& before = path.last.ray;
  const auto find = [&](const Vec3f& direction) {
    return media_->find_boundary({before.origin, direction}, last);
  };
  const FindBoundary find_boundary = std::cref(find);
  const WalkExit leaving{point, turn.direction};
  return medium.lamps.light_from_outside(
      path, leaving, light, samples,
      [&](const RefractedEntry& entry, float pdf) {
        const Bands leaves =
            exp_minus(
                media_->optical_thickness({before.origin, entry.to_surface}, last, entry.length)) *
            medium.layers.phase(last.depth.layer,
                                one_minus_cos(entry.to_surface, before.direction)) *
            path.last.carried;
        return weight_of_search(path.last, leaves, pdf, medium.layers.bands());
      },
      medium.has_neighbors ? &find_boundary : nullptr);
}

template <int N>
BandValues<N> MediaWalk<N>::search_beyond(const WalkBoundary& boundary, const SurfacePoint& point,
                                          const LightGatherer<N>& light,
                                          PixelSamples& samples) const {
  const float u_light = samples.next_1d();
  const LightSample lamp =
      media_->scene().lights.sample_light(point.position, u_light, samples.next_2d());
  if (!(lamp.pdf > 0.0f && lamp.next_event_share > 0.0f)) return {};
  const BoundaryLight through = light_through(boundary, lamp.direction, samples);
  if (!(through.value > 0.0f)) return {};
  const float weight = lamp.is_delta ? 1.0f : power_heuristic(lamp.pdf, through.pdf);
  return (weight * lamp.next_event_share * through.value / lamp.pdf) *
         light.shadow_transmittance({leave_surface(point, lamp.direction), lamp.direction},
                                    0.9999f * lamp.distance) *
         media_->conversion().from_rgb(lamp.radiance);
}

template <int N>
BandValues<N> MediaWalk<N>::light_beyond(const BoundaryTurn& turn, const SurfacePoint& point,
                                         const LightGatherer<N>& light,
                                         PixelSamples& samples) const {
  const Ray ray{leave_surface(point, turn.direction), turn.direction};
  Bands radiance = light.arriving_radiance(ray, samples);
  media_->scene().lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::infinity(), false, [&](const LightSeen& seen) {
        if (!(seen.next_event_share > 0.0f)) return;
        radiance += power_heuristic(turn.pdf, seen.pdf) * seen.next_event_share *
                    media_->conversion().from_rgb(seen.radiance) *
                    light.shadow_transmittance(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

#define LAMINA_INSTANTIATE(N)                                                                  \
  template BandValues<N> MediaWalk<N>::search(const WalkPath<N>&, const Place&,                \
                                              const LightGatherer<N>&, Random&) const;         \
  template BandValues<N> MediaWalk<N>::light_outside(                                          \
      const WalkPath<N>&, const Place&, const BoundaryTurn&, const SurfacePoint&,              \
      const LightGatherer<N>&, PixelSamples&) const;                                           \
  template BandValues<N> MediaWalk<N>::search_beyond(                                          \
      const WalkBoundary&, const SurfacePoint&, const LightGatherer<N>&, PixelSamples&) const; \
  template BandValues<N> MediaWalk<N>::light_beyond(const BoundaryTurn&, const SurfacePoint&,  \
                                                    const LightGatherer<N>&, PixelSamples&) const
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
