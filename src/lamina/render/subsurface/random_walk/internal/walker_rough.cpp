// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// How a random walk finds light through a rough boundary.
#include <algorithm>
#include <cmath>
#include <limits>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/render/subsurface/random_walk/internal/walker.h"

namespace lamina {
namespace {

constexpr int most_layers_passed = 100;

/// The power heuristic for three techniques.
float power_heuristic(float own, float second, float third) {
  if (!(own > 0.0f)) return 0.0f;
  const float b = second / own, c = third / own;
  return 1.0f / (1.0f + b * b + c * c);
}

/// A light as a point near to where it was sampled from sees it.
struct NearbyLight {
  Vec3f direction;
  float distance, nearer;  ///< the density of its direction there over that where it was sampled
};
NearbyLight seen_from(const Vec3f& there, const Vec3f& sampled_from, const LightSample& sample) {
  if (!std::isfinite(sample.distance)) return {sample.direction, sample.distance, 1.0f};
  const Vec3f offset = sampled_from + sample.distance * sample.direction - there;
  const float distance = length(offset), ratio = distance / sample.distance;
  const Vec3f direction = offset / distance;
  const float turned = dot(sample.normal, sample.normal) > 0.0f
                           ? dot(sample.direction, sample.normal) / dot(direction, sample.normal)
                           : 1.0f;
  return {direction, distance, ratio * ratio * turned};
}

/// The outside of a rough boundary, by one facet.
template <int N>
DielectricScattering facets_from_outside(const WalkLayers<N>& layers) {
  DielectricScattering facets = facet_scattering(layers.ior(), layers.boundary(0));
  facets.scattering = FacetScattering::single;
  return facets;
}

}  // namespace

template <int N>
std::optional<typename Walker<N>::WayOut> Walker<N>::way_out(const Vec3f& direction) const {
  const WalkLayers<N>& layers = last_place_.medium->layers;
  const DepthLayers& by_depth = layers.by_depth();
  MediaPlace<N> place = last_place_;
  Ray ray{path_.last.ray.origin, direction};
  Bands thickness;
  float transmitted = 1.0f;
  const auto add = [&](float part) {
    thickness += part * layers.medium(place.depth.layer).sigma_t;
  };
  for (int turns = 0; turns < most_layers_passed; ++turns) {
    const Surface surface =
        media_.next_surface(ray, place, turns == 0 ? 0.0f : least_distance(media_.scene()),
                            std::numeric_limits<float>::infinity());
    if (!surface.hit.is_hit() || surface.crossing.is_blocked || surface.beyond.medium)
      return std::nullopt;
    const auto end = by_depth.at_surface(surface.point.position, surface.hit, place.depth);
    std::optional<Crossing> refracting;
    float left = surface.hit.distance;
    for (int parts = 0; parts < most_layers_passed; ++parts) {
      const auto crossing = by_depth.first_crossing(ray, place.depth, left, end);
      const float part = crossing ? crossing->distance : left;
      add(part);
      if (!crossing) break;
      ray.origin += part * ray.direction;
      left -= part;
      const std::size_t here = place.depth.layer, next = crossing->place.layer;
      if (layers.own_ior(here) != layers.own_ior(next)) {
        refracting = crossing;
        break;
      }
      thickness += layers.crossing_thickness(here, *crossing, ray.direction);
      place.depth = crossing->place;
    }
    if (!refracting) return WayOut{surface, ray.direction, transmitted * exp_minus(thickness)};
    const std::size_t here = place.depth.layer, next = refracting->place.layer;
    const Interface& facets = layers.boundary(std::max(here, next));
    const float eta = layers.own_ior(next) / layers.own_ior(here);
    if (!is_specular(facet_scattering(eta, facets).interface)) return std::nullopt;
    const Vec3f n = next > here ? -refracting->place.outward : refracting->place.outward;
    const float cosine = std::min(dot(ray.direction, n), 1.0f);
    if (!(cosine > 0.0f)) return std::nullopt;
    const float reflected = fresnel(cosine, eta);
    if (!(reflected < 1.0f)) return std::nullopt;
    transmitted *= 1.0f - reflected;
    if (here < next) thickness += layers.crossing_thickness(here, *refracting, ray.direction);
    const float cos_beyond = cos_refracted(cosine, eta);
    ray.direction = normalize((1.0f / eta) * ray.direction + (cos_beyond - cosine / eta) * n);
    if (here > next) thickness += layers.crossing_thickness(here, *refracting, ray.direction);
    ray.origin += by_depth.nudge(ray.origin) * n;
    place.depth = refracting->place;
  }
  return std::nullopt;
}

template <int N>
float Walker<N>::pdf_through_facets(const Vec3f& direction, const Vec3f& to_light) const {
  const BodyMedium<N>& medium = *last_place_.medium;
  const Vec3f n = medium.interior.distance().nearest_normal(path_.last.ray.origin);
  if (!(dot(n, to_light) > 0.0f)) return 0.0f;
  const Framef frame = make_frame(n);
  const Vec3f here = frame.to_local(direction);
  // As flat layers refract it.
  const float ratio = medium.layers.own_ior(last_place_.depth.layer) / medium.layers.own_ior(0);
  const float x = ratio * here.x, y = ratio * here.y, z2 = 1.0f - x * x - y * y;
  if (!(here.z > 0.0f && z2 > 0.0f)) return 0.0f;
  const float z = std::sqrt(z2);
  return pdf_dielectric(facets_from_outside(medium.layers), frame.to_local(to_light),
                        {-x, -y, -z}) *
         ratio * ratio * here.z / z;
}

template <int N>
BandValues<N> Walker<N>::sample_light_through_facets() {
  const BodyMedium<N>& medium = *last_place_.medium;
  const WalkLayers<N>& layers = medium.layers;
  const Vec3f& origin = path_.last.ray.origin;
  const float u_light = samples_.next_1d();
  const LightSample sample =
      media_.scene().lights.sample_light(origin, u_light, samples_.next_2d());
  const Vec3f n = medium.interior.distance().nearest_normal(origin);
  if (!(sample.pdf > 0.0f && sample.next_event_share > 0.0f && dot(n, sample.direction) > 0.0f))
    return {};
  const Framef frame = make_frame(n);
  const DielectricSample facet =
      sample_dielectric(facets_from_outside(layers), frame.to_local(sample.direction), samples_);
  if (!(facet.weight > 0.0f && facet.wi.z < 0.0f)) return {};
  const float ratio = layers.own_ior(0) / layers.own_ior(last_place_.depth.layer);
  const float x = -ratio * facet.wi.x, y = -ratio * facet.wi.y, z2 = 1.0f - x * x - y * y;
  if (!(z2 > 0.0f)) return {};
  const Vec3f direction = normalize(frame.to_world({x, y, std::sqrt(z2)}));
  const float pdf = pdf_through_facets(direction, sample.direction);
  if (!(pdf > 0.0f)) return {};
  const std::optional<WayOut> way = way_out(direction);
  if (!way) return {};
  const SurfacePoint& point = way->surface.point;
  const WalkBoundary boundary = make_walk_boundary(
      point, way->direction, media_.boundary(last_place_, way->surface, way->direction));
  const auto [to_light, distance, nearer] = seen_from(point.position, origin, sample);
  const BoundaryLight through = light_through(boundary, to_light, samples_);
  if (!(through.value > 0.0f)) return {};
  const Bands scattered =
      way->passing *
      layers.phase(last_place_.depth, one_minus_cos(direction, path_.last.ray.direction));
  const float of_paths = density_of_paths(scattered);
  const float pdf_light = nearer * sample.pdf;
  if (!(pdf_light > 0.0f)) return {};  // beside its edge
  // As the others sample it, from the boundary.
  const float pdf_there =
      std::isfinite(distance) && !sample.is_delta
          ? media_.scene().lights.pdf_of_area_light(point.position, to_light, distance)
          : pdf_light;
  const float of_leaving =
      sample.is_delta || !(pdf_there > 0.0f) ? 0.0f : of_paths * through.pdf / pdf_there;
  const float weight = power_heuristic(path_.last.next_event_rate * pdf, of_paths, of_leaving);
  return (weight * sample.next_event_share * through.value / (pdf_light * pdf)) * scattered *
         light_.shadow_transmittance({leave_surface(point, to_light), to_light},
                                     0.9999f * distance) *
         media_.conversion().from_rgb(sample.radiance);
}

template <int N>
float Walker<N>::arriving_density() const {
  if (!path_.comes_from_event || !finds_light_through_facets(*last_place_.medium)) return 0.0f;
  const Vec3f& direction = path_.last.turned;
  const std::optional<WayOut> way = way_out(direction);
  if (!way) return 0.0f;
  return density_of_paths(
      way->passing * last_place_.medium->layers.phase(
                         last_place_.depth, one_minus_cos(direction, path_.last.ray.direction)));
}

template <int N>
float Walker<N>::facets_over_paths(float arriving, const SurfacePoint& point, const Vec3f& to_light,
                                   float distance) const {
  if (!(arriving > 0.0f)) return 0.0f;
  const Vec3f seen = std::isfinite(distance)
                         ? normalize(point.position + distance * to_light - path_.last.ray.origin)
                         : to_light;
  return path_.last.next_event_rate * pdf_through_facets(path_.last.turned, seen) / arriving;
}

template <int N>
BandValues<N> Walker<N>::sample_direct_light(const WalkBoundary& boundary,
                                             const SurfacePoint& point, float arriving) {
  const float u_light = samples_.next_1d();
  const LightSample sample =
      media_.scene().lights.sample_light(point.position, u_light, samples_.next_2d());
  if (!(sample.pdf > 0.0f && sample.next_event_share > 0.0f)) return {};
  const BoundaryLight through = light_through(boundary, sample.direction, samples_);
  if (!(through.value > 0.0f)) return {};
  // Densities over that of paths that come here.
  const float weight =
      power_heuristic(1.0f, facets_over_paths(arriving, point, sample.direction, sample.distance),
                      sample.is_delta ? 0.0f : through.pdf / sample.pdf);
  return (weight * sample.next_event_share * through.value / sample.pdf) *
         light_.shadow_transmittance({leave_surface(point, sample.direction), sample.direction},
                                     0.9999f * sample.distance) *
         media_.conversion().from_rgb(sample.radiance);
}

template <int N>
BandValues<N> Walker<N>::escaping_radiance(const BoundaryTurn& turn, const SurfacePoint& point,
                                           float arriving) {
  const Ray ray{leave_surface(point, turn.direction), turn.direction};
  Bands radiance = light_.arriving_radiance(ray, samples_);
  media_.scene().lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::infinity(), false, [&](const LightSeen& seen) {
        if (!(seen.next_event_share > 0.0f)) return;
        const float of_facets = facets_over_paths(arriving, point, turn.direction, seen.distance);
        radiance += power_heuristic(turn.pdf, seen.pdf, of_facets * seen.pdf) *
                    seen.next_event_share * media_.conversion().from_rgb(seen.radiance) *
                    light_.shadow_transmittance(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

#define LAMINA_INSTANTIATE(N)                                                                     \
  template BandValues<N> Walker<N>::sample_light_through_facets();                                \
  template float Walker<N>::arriving_density() const;                                             \
  template BandValues<N> Walker<N>::sample_direct_light(const WalkBoundary&, const SurfacePoint&, \
                                                        float);                                   \
  template BandValues<N> Walker<N>::escaping_radiance(const BoundaryTurn&, const SurfacePoint&,   \
                                                      float)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
