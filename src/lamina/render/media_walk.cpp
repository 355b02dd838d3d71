// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/media_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "lamina/render/refracted_entry.h"

namespace lamina {
namespace {

constexpr int most_turns = 200'000;
constexpr std::uint32_t walks = 4;  // from where a ray of the eye enters
constexpr float least_search = 0.05f;

/// Source: [VeachGuibas1995].
[[nodiscard]] float power_heuristic(float own, float other) {
  return own * own / (own * own + other * other);
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
MediaWalk<N>::MediaWalk(const RenderScene& scene, const BandConversion<N>& conversion,
                        std::uint32_t material)
    : layers_(scene, material),
      space_(scene, conversion, material, layers_.ior(), layers_.bands(),
             layers_.shortest_free_path()),
      // Nothing is asked of what lamps send beforehand: a lattice as coarse as can be.
      lamps_(space_, layers_.medium(0).sigma_t, layers_.medium(0).sigma_t, 1e6f),
      facets_(layers_.boundary()),
      is_rough_(!is_specular(make_rough_interface<double>(facets_, layers_.ior(), 1.0))) {
  require_closed_meshes(*scene.scene, material);
}

template <int N>
BandValues<N> MediaWalk<N>::leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                             PixelSamples& samples) const {
  Bands radiance;
  for (std::uint32_t i = 0; i < walks; ++i) {
    PixelSamples own = samples.branch(i, walks);
    radiance += walk(exit, light, own);
  }
  return (1.0f / static_cast<float>(walks)) * radiance;
}

template <int N>
typename MediaWalk<N>::Step MediaWalk<N>::advance(WalkPath<N>& path, Place& place,
                                                  WalkNumbers& numbers) const {
  const RenderScene& scene = space_.scene();
  const Vec2f u = numbers.pair();
  const int band = space_.draw_band(path.carried, u.x);
  float left = -std::log(1.0f - u.y);  // optical, in the band
  const float least = layers_.least_extinction(band);
  const float reach = least > 0.0f ? 1.001f * left / least : 1e9f;
  Hit hit;
  if (!(reach < path.safe))
    hit = scene.geometry.first_hit(path.ray, path.has_scattered ? 0.0f : least_distance(scene),
                                   reach);
  if (!hit.is_hit() && !(least > 0.0f)) return {};  // through a hole
  Bands extinction;
  float length = 0.0f;
  const WalkMedium<N>* medium = nullptr;  // where it scatters
  layers_.by_depth().for_parts(path.ray, place, std::min(hit.distance, reach),
                               [&](std::size_t layer, float part) {
                                 const WalkMedium<N>& here = layers_.medium(layer);
                                 const float whole = part * here.sigma_t[band];
                                 if (left < whole) {
                                   medium = &here;
                                   part *= left / whole;
                                 }
                                 left -= whole;
                                 length += part;
                                 extinction += part * here.sigma_t;
                                 return !medium;
                               });
  if (!medium && !hit.is_hit()) return {};

  // exp(-extinction) of each band; what all share cancels.
  const float shared = *std::min_element(extinction.v, extinction.v + layers_.bands());
  Bands passing = exp_minus(extinction - Bands::filled(shared)) * path.carried;
  const Bands density = medium ? medium->sigma_t * passing : passing;
  if (medium) passing *= medium->sigma_s;
  float carried = 0.0f, drawn_density = 0.0f;
  for (int b = 0; b < layers_.bands(); ++b) {
    carried += path.carried[b];
    drawn_density += density[b];
  }
  if (!(drawn_density > 0.0f)) return {};  // beyond what floats hold
  path.carried = (carried / drawn_density) * passing;
  if (medium) {
    path.ray.origin += length * path.ray.direction;
    place = layers_.by_depth().at(path.ray.origin);
    path.safe = std::max(space_.safe().at(path.ray.origin), 0.0f);
    path.has_scattered = true;
    return {Step::End::event, {}};
  }
  return {Step::End::surface, hit};
}

template <int N>
BandValues<N> MediaWalk<N>::search(const WalkPath<N>& path, const Place& place,
                                   const LightGatherer<N>& light, Random& random) const {
  Bands found;
  const float u_light = random.uniform_float();
  const Vec2f u{random.uniform_float(), random.uniform_float()};
  lamps_.search(path.ray.origin, u_light, u, light, [&](const FoundLamp<N>& lamp) {
    const Vec3f& direction = lamp.entry.to_surface;
    const Bands turned = exp_minus(layers_.optical_thickness({path.ray.origin, direction}, place,
                                                             lamp.entry.length)) *
                         layers_.phase(place.layer, dot(direction, path.ray.direction));
    found += weight_of_search(path.last, turned * path.last.carried, lamp.pdf, layers_.bands()) *
             turned * lamp.unweakened;
  });
  return found;
}

template <int N>
BandValues<N> MediaWalk<N>::light_outside(const WalkPath<N>& path, const Place& last,
                                          const BoundaryTurn& turn, const SurfacePoint& point,
                                          const LightGatherer<N>& light,
                                          PixelSamples& samples) const {
  const WalkStep leaving{WalkStep::End::leaves, point, turn.direction};
  return lamps_.light_from_outside(
      path, leaving, light, samples, [&](const RefractedEntry& entry, float pdf) {
        const Ray& ray = path.last.ray;
        const Bands leaves = exp_minus(layers_.optical_thickness({ray.origin, entry.to_surface},
                                                                 last, entry.length)) *
                             layers_.phase(last.layer, dot(entry.to_surface, ray.direction)) *
                             path.last.carried;
        return weight_of_search(path.last, leaves, pdf, layers_.bands());
      });
}

template <int N>
BandValues<N> MediaWalk<N>::search_beyond(const WalkBoundary& boundary, const SurfacePoint& point,
                                          const LightGatherer<N>& light,
                                          PixelSamples& samples) const {
  const float u_light = samples.next_1d();
  const LightSample lamp =
      space_.scene().lights.sample_light(point.position, u_light, samples.next_2d());
  const bool is_sky = !lamp.is_delta && !std::isfinite(lamp.distance);
  if (!(lamp.pdf > 0.0f) || is_sky) return {};
  const BoundaryLight through = light_through(boundary, lamp.direction, samples);
  if (!(through.value > 0.0f)) return {};
  const float weight = lamp.is_delta ? 1.0f : power_heuristic(lamp.pdf, through.pdf);
  return (weight * through.value / lamp.pdf) *
         light.clear_fraction({leave_surface(point, lamp.direction), lamp.direction},
                              0.9999f * lamp.distance) *
         space_.conversion().from_rgb(lamp.radiance);
}

template <int N>
BandValues<N> MediaWalk<N>::light_beyond(const BoundaryTurn& turn, const SurfacePoint& point,
                                         const LightGatherer<N>& light,
                                         PixelSamples& samples) const {
  const Ray ray{leave_surface(point, turn.direction), turn.direction};
  Bands radiance = light.arriving_radiance(ray, samples);
  space_.scene().lights.for_lights_seen(
      ray, 0.0f, std::numeric_limits<float>::max(), false, [&](const LightSeen& seen) {
        if (!seen.is_lamp) return;
        radiance += power_heuristic(turn.pdf, seen.pdf) *
                    space_.conversion().from_rgb(seen.radiance) *
                    light.clear_fraction(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

template <int N>
BandValues<N> MediaWalk<N>::walk(const ExitPoint& exit, const LightGatherer<N>& light,
                                 PixelSamples& samples) const {
  const Vec3f inward =
      sample_entry(exit.to_eye, exit.point.normal, layers_.ior(), facets_, samples);
  if (!(dot(inward, exit.point.geometric_normal) < 0.0f)) return {};
  WalkNumbers numbers(samples);
  Random& random = numbers.stream();
  WalkPath<N> path{.ray = {leave_surface(exit.point, inward), inward},
                   .carried = Bands::filled(1.0f - reflectance(exit.boundary, exit.cos_o))};
  Bands radiance;
  Place place = layers_.by_depth().at(path.ray.origin), last = place;
  for (int turns = 0; turns < most_turns; ++turns) {
    const Step step = advance(path, place, numbers);
    if (step.end == Step::End::lost) break;
    if (step.end == Step::End::event) {
      // From deep inside a search finds little, and is seldom.
      const float searching =
          lamps_.are_there() && !is_rough_
              ? std::clamp(std::exp(-layers_.least_optical_depth(place)), least_search, 1.0f)
              : 0.0f;
      const float going = std::min(largest(path.carried), 1.0f);
      path.last = {path.ray, path.carried, searching, going};
      last = place;
      if (random.uniform_float() < searching)
        radiance += (1.0f / searching) * path.carried * search(path, place, light, random);
      if (!(random.uniform_float() < going)) break;
      path.carried *= 1.0f / going;
      layers_.scatter(place.layer, path, numbers);
      continue;
    }
    const SurfacePoint point = make_bare_surface_point(space_.scene().scene->meshes, step.hit);
    if (space_.is_blocker(point, path.ray.direction)) {
      space_.bounce(path, point, step.hit, numbers.pair());
    } else {
      const WalkBoundary boundary =
          make_walk_boundary(point, path.ray.direction, 1.0f / layers_.ior(), facets_);
      if (is_rough_ && lamps_.are_there())
        radiance += path.carried * search_beyond(boundary, point, light, samples);
      const BoundaryTurn turn = sample_turn(boundary, samples);
      if (turn.passes)
        return radiance +
               path.carried * (is_rough_ ? light_beyond(turn, point, light, samples)
                                         : light_outside(path, last, turn, point, light, samples));
      path.ray.direction = turn.direction;
    }
    path.ray.origin = leave_surface(point, path.ray.direction);
    path.has_scattered = false;
    path.safe = 0.0f;
    place = layers_.by_depth().at(path.ray.origin);
  }
  return radiance;
}

bool is_for_media_walk(const SurfaceMaterial& material) {
  const auto* surface = std::get_if<SubsurfaceSurface>(&material.surface);
  if (!surface) return false;
  const std::vector<MaterialLayer>& layers = surface->material.layers;
  const Interface& facets = layers.front().top;
  return layers.size() > 1 || !is_specular(make_rough_interface<double>(
                                  facets, layers.front().ior[0], surface->material.ior_above[0]));
}

template class MediaWalk<4>;
template class MediaWalk<8>;
template class MediaWalk<16>;

}  // namespace lamina
