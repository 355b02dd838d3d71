// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How a random walk gets from one scattering event, surface or layer to the next.
#include <algorithm>
#include <cmath>

#include "lamina/render/subsurface/random_walk/internal/walker.h"

namespace lamina {
namespace {

constexpr int most_flights = 100'000;  // from one event or surface to the next
constexpr float far = 1e9f;

}  // namespace

template <int N>
bool Walker<N>::weigh(const Bands& value, const Bands& density) {
  const int bands = place_.medium->layers.bands();
  const Bands weighted = path_.throughput * density;
  float throughput = 0.0f, density_of_mixture = 0.0f;
  for (int b = 0; b < bands; ++b) {
    throughput += path_.throughput[b];
    density_of_mixture += weighted[b];
  }
  if (!(density_of_mixture > 0.0f)) return false;
  path_.throughput = (throughput / density_of_mixture) * path_.throughput * value;
  return true;
}

template <int N>
void Walker<N>::look_ahead(float end, float free_path, Ahead& ahead) const {
  if (end < ahead.clear || ahead.surface.hit.is_hit()) return;
  const DistanceField& distance = place_.medium->interior.distance();
  const auto around = [&] { return distance.at(path_.ray.origin + end * path_.ray.direction); };
  if (ahead.clear > 0.0f && end < ahead.clear + std::max(around(), 0.0f)) return;
  // Where light may pass on, a ray goes further.
  const float t_far = 1.001f * end + free_path;
  ahead.surface = media_.next_surface(path_.ray, place_, ahead.t_near, t_far);
  ahead.clear = std::min(ahead.surface.hit.distance, t_far);
}

template <int N>
typename Walker<N>::Step Walker<N>::advance() {
  using End = Step::End;
  const auto point = [&](float t) { return path_.ray.origin + t * path_.ray.direction; };
  Ahead ahead{{}, path_.clearance, path_.has_scattered ? 0.0f : least_distance(media_.scene())};
  float begin = 0.0f;
  for (int flights = 0; flights < most_flights; ++flights) {
    const WalkLayers<N>& layers = place_.medium->layers_after(path_.events);
    const DepthLayers& by_depth = layers.by_depth();
    const std::size_t layer = place_.depth.layer;
    const Bands& most = layers.most_extinction(layer);
    const Vec2f u = numbers_.pair();
    const int band = sample_band(path_.throughput, layers.bands(), u.x);
    const float free_path = most[band] > 0.0f ? 1.0f / most[band] : far;
    const float drawn = std::min(-std::log(1.0f - u.y) * free_path, far);
    const bool is_last = layer + 1 == by_depth.count();
    const float flight = is_last ? drawn : std::min(drawn, by_depth.longest_above());
    look_ahead(begin + flight, layers.is_mapped(layer) ? 2.0f * free_path : 0.0f, ahead);
    const Surface& surface = ahead.surface;
    const bool is_stopped = surface.hit.is_hit() && surface.hit.distance <= begin + flight;
    if (!is_stopped && flight == far) return {};  // through a hole
    const float end = is_stopped ? surface.hit.distance : begin + flight;
    const typename DepthLayers::Place there =
        is_stopped ? by_depth.at_surface(surface.point.position, surface.hit, place_.depth)
                   : by_depth.at(point(end), place_.depth);
    const auto crossing = by_depth.first_crossing({point(begin), path_.ray.direction}, place_.depth,
                                                  end - begin, there);
    const float length = crossing ? crossing->distance : end - begin;
    // exp(-extinction) of each band; what all share cancels.
    const float least = *std::min_element(most.v, most.v + layers.bands());
    Bands passing = exp_minus(length * (most - Bands::filled(least)));
    if (crossing) {
      if (!weigh(passing, passing)) return {};
      if (layers.own_ior(layer) != layers.own_ior(crossing->place.layer)) {
        path_.ray.origin = point(begin + length);
        return {.end = End::layer, .crossing = *crossing};
      }
      path_.throughput *=
          exp_minus(layers.crossing_thickness(layer, *crossing, path_.ray.direction));
      place_.depth = crossing->place;
      begin += length;
      continue;
    }
    place_.depth = there;
    begin = end;
    if (is_stopped || flight < drawn) {
      if (!weigh(passing, passing)) return {};
      if (!is_stopped) continue;
      if (!surface.passes) return {.end = End::surface, .surface = surface};
      // The ray goes on from its last event, which connections to lights start from.
      place_ = surface.beyond;
      ahead = {{}, begin, distance_behind(surface.hit, surface.point)};
      continue;
    }
    const Collision collision = collide(passing, most);
    if (collision == Collision::lost) return {};
    if (collision == Collision::none) continue;
    path_.ray.origin = point(begin);
    path_.clearance = std::max(place_.medium->interior.distance().at(path_.ray.origin), 0.0f);
    path_.has_scattered = path_.comes_from_event = true;
    ++path_.events;
    return {.end = End::event};
  }
  return {};
}

template <int N>
typename Walker<N>::Collision Walker<N>::collide(const Bands& passing, const Bands& most) {
  const WalkLayers<N>& layers = place_.medium->layers_after(path_.events);
  Random& random = numbers_.stream();
  const bool is_mapped = layers.is_mapped(place_.depth.layer);
  if (is_mapped) place_.depth.texel = layers.sample_texel(place_.depth, random.uniform_float());
  const auto [sigma_s, sigma_t] = layers.coefficients(place_.depth);
  const auto of = [](bool is_held, Collision collision) {
    return is_held ? collision : Collision::lost;
  };
  if (!is_mapped) return of(weigh(passing * sigma_s, passing * sigma_t), Collision::real);
  if (!weigh(most * passing, most * passing)) return Collision::lost;
  const Bands per_most = Bands::filled(1.0f) / max(most, Bands::filled(1e-30f));
  const Bands share = sigma_t * per_most;
  float throughput = 0.0f, real = 0.0f;
  for (int b = 0; b < layers.bands(); ++b) {
    throughput += path_.throughput[b];
    real += path_.throughput[b] * share[b];
  }
  if (random.uniform_float() * throughput < real)
    return of(weigh(sigma_s * per_most, share), Collision::real);
  const Bands rest = max(Bands::filled(1.0f) - share, Bands{});
  return of(weigh(rest, rest), Collision::none);
}

template <int N>
void Walker<N>::restart() {
  path_.has_scattered = false;
  path_.clearance = 0.0f;
  place_ = media_.place(place_.interior, path_.ray.origin, place_);
}

template <int N>
void Walker<N>::meet_layer(const Crossing& crossing) {
  const WalkLayers<N>& layers = place_.medium->layers;
  const std::size_t here = place_.depth.layer, next = crossing.place.layer;
  const std::size_t deeper = std::max(here, next);
  const Vec3f& outward = crossing.place.outward;
  const SurfacePoint point{.position = path_.ray.origin,
                           .geometric_normal = outward,
                           .smooth_normal = outward,
                           .normal = outward};
  const auto cross_sheet = [&] {
    path_.throughput *= exp_minus(layers.crossing_thickness(here, crossing, path_.ray.direction));
  };
  const WalkBoundary boundary = make_walk_boundary(
      point, path_.ray.direction,
      facet_scattering(layers.own_ior(next) / layers.own_ior(here), layers.boundary(deeper)));
  const BoundaryTurn turn = sample_turn(boundary, samples_);
  // A sheet lies on the boundary, in the upper layer.
  if (here < next) cross_sheet();
  path_.ray.direction = turn.direction;
  if (!turn.passes) path_.comes_from_event = false;
  const bool goes_deeper = (turn.passes ? next : here) == deeper;
  if (!goes_deeper) cross_sheet();
  const float nudge = layers.by_depth().nudge(path_.ray.origin);
  path_.ray.origin += (goes_deeper ? -nudge : nudge) * outward;
  place_.depth = crossing.place;
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
    const bool counts = with_unscattered_ || path_.events > 0;
    const float arriving = is_rough && is_outside ? arriving_density() : 0.0f;
    if (counts && is_rough && is_outside && medium.next_event.has_lights())
      radiance_ += path_.throughput * sample_direct_light(boundary, point, arriving);
    const BoundaryTurn turn = sample_turn(boundary, samples_);
    if (!(turn.weight > 0.0f)) return false;
    path_.throughput *= turn.weight;
    if (turn.passes && is_outside) {
      if (counts)
        radiance_ +=
            path_.throughput * (is_rough ? escaping_radiance(turn, point, arriving)
                                         : escaping_radiance(path_, {point, turn.direction}));
      return false;
    }
    path_.ray.direction = turn.direction;
    if (turn.passes) place_.interior = surface.crossing.beyond;
  }
  path_.comes_from_event = false;
  path_.ray.origin = leave_surface(point, path_.ray.direction);
  restart();
  return true;
}

#define LAMINA_INSTANTIATE(N)                             \
  template typename Walker<N>::Step Walker<N>::advance(); \
  template bool Walker<N>::meet_surface(const Surface&);  \
  template void Walker<N>::meet_layer(const Crossing&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
