// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How a random walk gets from one scattering event, surface or layer to the next.
#include <algorithm>
#include <cmath>

#include "lamina/render/subsurface/random_walk/internal/walker.h"

namespace lamina {
namespace {

constexpr int most_bodies_of_ray = 1000;  // along one ray

}  // namespace

template <int N>
typename Walker<N>::Step Walker<N>::advance() {
  const int bands = place_.medium->layers.bands();
  const Vec2f u = numbers_.pair();
  const int band = sample_band(path_.throughput, bands, u.x);
  float left = -std::log(1.0f - u.y);  // optical, in the band
  Bands extinction;
  const WalkMedium<N>* scatterer = nullptr;
  Step step;
  float begin = 0.0f;  // of the segment in one body
  float t_near = path_.has_scattered ? 0.0f : least_distance(media_.scene());
  for (int bodies = 0; bodies < most_bodies_of_ray; ++bodies) {
    const WalkLayers<N>& layers = place_.medium->layers;
    const float least = layers.least_extinction(band);
    const float t_far = least > 0.0f ? begin + 1.001f * left / least : 1e9f;
    Surface surface;
    if (!(t_far < path_.clearance)) surface = media_.next_surface(path_.ray, place_, t_near, t_far);
    if (!surface.hit.is_hit() && !(least > 0.0f)) return {};  // through a hole
    float end = begin;
    const std::size_t first = place_.depth.layer;
    const Ray rest{path_.ray.origin + begin * path_.ray.direction, path_.ray.direction};
    layers.by_depth().for_parts(rest, place_.depth, std::min(surface.hit.distance, t_far) - begin,
                                [&](std::size_t layer, float part) {
                                  if (layers.own_ior(layer) != layers.own_ior(first)) {
                                    step = {Step::End::layer, {}, layer};
                                    return false;
                                  }
                                  place_.depth.layer = layer;
                                  const WalkMedium<N>& here = layers.medium(layer);
                                  const float whole = part * here.sigma_t[band];
                                  if (left < whole) {
                                    scatterer = &here;
                                    part *= left / whole;
                                  }
                                  left -= whole;
                                  end += part;
                                  extinction += part * here.sigma_t;
                                  return !scatterer;
                                });
    if (scatterer) {
      path_.ray.origin += end * path_.ray.direction;
      place_.depth = layers.by_depth().at(path_.ray.origin);
      path_.clearance = std::max(place_.medium->interior.distance().at(path_.ray.origin), 0.0f);
      path_.has_scattered = true;
      step.end = Step::End::event;
      break;
    }
    if (step.end == Step::End::layer) {
      path_.ray.origin += end * path_.ray.direction;
      break;
    }
    if (!surface.hit.is_hit()) return {};
    if (!surface.passes) {
      step = {Step::End::surface, surface};
      break;
    }
    begin = surface.hit.distance;
    t_near = distance_behind(surface.hit, surface.point);
    place_ = surface.beyond;
  }

  // exp(-extinction) of each band; what all share cancels.
  const float shared = *std::min_element(extinction.v, extinction.v + bands);
  Bands passing = exp_minus(extinction - Bands::filled(shared)) * path_.throughput;
  const Bands density = scatterer ? scatterer->sigma_t * passing : passing;
  if (scatterer) passing *= scatterer->sigma_s;
  float throughput = 0.0f, density_of_mixture = 0.0f;
  for (int b = 0; b < bands; ++b) {
    throughput += path_.throughput[b];
    density_of_mixture += density[b];
  }
  if (!(density_of_mixture > 0.0f)) return {};  // beyond what floats hold
  path_.throughput = (throughput / density_of_mixture) * passing;
  return step;
}

template <int N>
void Walker<N>::restart() {
  path_.has_scattered = false;
  path_.clearance = 0.0f;
  place_ = media_.place(place_.interior, path_.ray.origin);
}

template <int N>
void Walker<N>::meet_layer(std::size_t next) {
  const WalkLayers<N>& layers = place_.medium->layers;
  const Vec3f outward = layers.by_depth().outward(path_.ray.origin);
  const SurfacePoint point{.position = path_.ray.origin,
                           .geometric_normal = outward,
                           .smooth_normal = outward,
                           .normal = outward};
  const std::size_t here = place_.depth.layer, deeper = std::max(here, next);
  const WalkBoundary boundary = make_walk_boundary(
      point, path_.ray.direction,
      facet_scattering(layers.own_ior(next) / layers.own_ior(here), layers.boundary(deeper)));
  const BoundaryTurn turn = sample_turn(boundary, samples_);
  path_.ray.direction = turn.direction;
  const bool goes_deeper = (turn.passes ? next : here) == deeper;
  const float nudge = layers.by_depth().nudge(path_.ray.origin);
  path_.ray.origin += (goes_deeper ? -nudge : nudge) * outward;
  restart();
}

/// Reflects or refracts the path at a surface; adds the light from outside if it leaves there.
template <int N>
bool Walker<N>::meet_surface(const Surface& surface) {
  const BodyMedium<N>& medium = *place_.medium;
  const SurfacePoint& point = surface.point;
  if (surface.crossing.is_blocked) {
    medium.interior.reflect_diffusely(path_, point, surface.hit, numbers_.pair());
  } else {
    const bool is_outside = !surface.beyond.medium;
    const Vec3f& direction = path_.ray.direction;
    const WalkBoundary boundary =
        make_walk_boundary(point, direction, media_.boundary(place_, surface, direction));
    const bool is_rough = !is_specular(boundary.scattering.interface);
    if (is_rough && is_outside && medium.next_event.has_lights())
      radiance_ += path_.throughput * sample_direct_light(boundary, point);
    const BoundaryTurn turn = sample_turn(boundary, samples_);
    if (!(turn.weight > 0.0f)) return false;
    path_.throughput *= turn.weight;
    if (turn.passes && is_outside) {
      radiance_ +=
          path_.throughput * (is_rough ? escaping_radiance(turn, point)
                                       : escaping_radiance(path_, {point, turn.direction}));
      return false;
    }
    path_.ray.direction = turn.direction;
    if (turn.passes) place_.interior = surface.crossing.beyond;
  }
  path_.ray.origin = leave_surface(point, path_.ray.direction);
  restart();
  return true;
}

#define LAMINA_INSTANTIATE(N)                             \
  template typename Walker<N>::Step Walker<N>::advance(); \
  template bool Walker<N>::meet_surface(const Surface&);  \
  template void Walker<N>::meet_layer(std::size_t)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
