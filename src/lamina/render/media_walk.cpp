// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/media_walk.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "lamina/core/error.h"

namespace lamina {
namespace {

constexpr int most_turns = 200'000, most_bodies = 1000;  // of a path; on one way
constexpr std::uint32_t walks = 4;                       // from where a ray of the eye enters
constexpr float least_search = 0.05f;

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

bool is_for_media_walk(const RenderScene& scene, std::uint32_t material) {
  const Material& layers =
      std::get<SubsurfaceSurface>(scene.scene->materials[material].surface).material;
  return layers.layers.size() > 1 || WalkBodies(scene).is_near_others(material) ||
         !is_specular(make_rough_interface<double>(
             layers.layers.front().top, layers.layers.front().ior[0], layers.ior_above[0]));
}

template <int N>
MediaWalk<N>::MediaWalk(std::shared_ptr<const WalkMedia<N>> media, std::uint32_t material)
    : media_(std::move(media)) {
  const Scene& scene = *media_->scene().scene;
  require_closed_meshes(scene, material);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    if (std::ranges::find(scene.meshes[m].material, material) != scene.meshes[m].material.end() &&
        media_->bodies().material_of(m) != material)
      throw InvalidInput("mesh \"" + scene.meshes[m].name + "\": random_walk takes one medium " +
                         "inside a mesh, but this one has \"" + scene.materials[material].name +
                         "\" and \"" + scene.materials[media_->bodies().material_of(m)].name +
                         "\"; split it");
  if (const BodyMedium<N>* own = media_->of_material(material))
    reflectance_ = own->layers.diffuse_reflectance();
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
  const int bands = place.medium->layers.bands();
  const Vec2f u = numbers.pair();
  const int band = draw_band(path.carried, bands, u.x);
  float left = -std::log(1.0f - u.y);  // optical, in the band
  Bands extinction;
  const WalkMedium<N>* scatterer = nullptr;
  Step step;
  float begin = 0.0f;  // of the part of the way in one body
  float t_near = path.has_scattered ? 0.0f : least_distance(media_->scene());
  for (int bodies = 0; bodies < most_bodies; ++bodies) {
    const WalkLayers<N>& layers = place.medium->layers;
    const float least = layers.least_extinction(band);
    const float reach = least > 0.0f ? begin + 1.001f * left / least : 1e9f;
    Surface surface;
    if (!(reach < path.safe)) surface = media_->next_surface(path.ray, place, t_near, reach);
    if (!surface.hit.is_hit() && !(least > 0.0f)) return {};  // through a hole
    float end = begin;
    const Ray rest{path.ray.origin + begin * path.ray.direction, path.ray.direction};
    layers.by_depth().for_parts(rest, place.depth, std::min(surface.hit.distance, reach) - begin,
                                [&](std::size_t layer, float part) {
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
      path.ray.origin += end * path.ray.direction;
      place.depth = layers.by_depth().at(path.ray.origin);
      path.safe = std::max(place.medium->space.safe().at(path.ray.origin), 0.0f);
      path.has_scattered = true;
      step.end = Step::End::event;
      break;
    }
    if (!surface.hit.is_hit()) return {};
    if (!surface.passes) {
      step = {Step::End::surface, surface};
      break;
    }
    begin = surface.hit.distance;
    t_near = behind(surface.hit, surface.point);
    place = media_->place(surface.crossing.beyond, path.ray.origin + begin * path.ray.direction);
  }

  // exp(-extinction) of each band; what all share cancels.
  const float shared = *std::min_element(extinction.v, extinction.v + bands);
  Bands passing = exp_minus(extinction - Bands::filled(shared)) * path.carried;
  const Bands density = scatterer ? scatterer->sigma_t * passing : passing;
  if (scatterer) passing *= scatterer->sigma_s;
  float carried = 0.0f, drawn_density = 0.0f;
  for (int b = 0; b < bands; ++b) {
    carried += path.carried[b];
    drawn_density += density[b];
  }
  if (!(drawn_density > 0.0f)) return {};  // beyond what floats hold
  path.carried = (carried / drawn_density) * passing;
  return step;
}

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
            medium.layers.phase(place.depth.layer, dot(direction, path.ray.direction));
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
  const WalkStep leaving{WalkStep::End::leaves, point, turn.direction};
  return medium.lamps.light_from_outside(
      path, leaving, light, samples,
      [&](const RefractedEntry& entry, float pdf) {
        const Bands leaves =
            exp_minus(
                media_->optical_thickness({before.origin, entry.to_surface}, last, entry.length)) *
            medium.layers.phase(last.depth.layer, dot(entry.to_surface, before.direction)) *
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
  const bool is_sky = !lamp.is_delta && !std::isfinite(lamp.distance);
  if (!(lamp.pdf > 0.0f) || is_sky) return {};
  const BoundaryLight through = light_through(boundary, lamp.direction, samples);
  if (!(through.value > 0.0f)) return {};
  const float weight = lamp.is_delta ? 1.0f : power_heuristic(lamp.pdf, through.pdf);
  return (weight * through.value / lamp.pdf) *
         light.clear_fraction({leave_surface(point, lamp.direction), lamp.direction},
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
      ray, 0.0f, std::numeric_limits<float>::max(), false, [&](const LightSeen& seen) {
        if (!seen.is_lamp) return;
        radiance += power_heuristic(turn.pdf, seen.pdf) *
                    media_->conversion().from_rgb(seen.radiance) *
                    light.clear_fraction(ray, 0.9999f * seen.distance);
      });
  return radiance;
}

template <int N>
BandValues<N> MediaWalk<N>::walk(const ExitPoint& exit, const LightGatherer<N>& light,
                                 PixelSamples& samples) const {
  const WalkBodies::Crossing entry = media_->bodies().cross({}, exit.point, -exit.to_eye);
  Place place = media_->place(entry.beyond, exit.point.position);
  if (entry.is_blocked || !place.medium) return {};
  const Vec3f inward = sample_entry(exit.to_eye, exit.point.normal, place.medium->layers.ior(),
                                    place.medium->layers.boundary(), samples);
  if (!(dot(inward, exit.point.geometric_normal) < 0.0f)) return {};
  const bool are_lamps_there = place.medium->lamps.are_there();
  WalkNumbers numbers(samples);
  Random& random = numbers.stream();
  WalkPath<N> path{.ray = {leave_surface(exit.point, inward), inward},
                   .carried = Bands::filled(1.0f - reflectance(exit.boundary, exit.cos_o))};
  Bands radiance;
  Place last = place;
  for (int turns = 0; turns < most_turns; ++turns) {
    const Step step = advance(path, place, numbers);
    if (step.end == Step::End::lost) break;
    const WalkLayers<N>& layers = place.medium->layers;
    if (step.end == Step::End::event) {
      // From deep inside a search finds little, and is seldom.
      const float searching =
          are_lamps_there && !place.medium->is_rough
              ? std::clamp(std::exp(-layers.least_optical_depth(place.depth)), least_search, 1.0f)
              : 0.0f;
      const float going = std::min(largest(path.carried), 1.0f);
      path.last = {path.ray, path.carried, searching, going};
      last = place;
      if (random.uniform_float() < searching)
        radiance += (1.0f / searching) * path.carried * search(path, place, light, random);
      if (!(random.uniform_float() < going)) break;
      path.carried *= 1.0f / going;
      layers.scatter(place.depth.layer, path, numbers);
      continue;
    }
    const Surface& surface = step.surface;
    const SurfacePoint& point = surface.point;
    if (surface.crossing.is_blocked) {
      place.medium->space.bounce(path, point, surface.hit, numbers.pair());
    } else {
      const WalkBoundary boundary =
          make_walk_boundary(point, path.ray.direction,
                             surface.beyond ? surface.beyond->layers.own_ior() / layers.own_ior()
                                            : 1.0f / layers.ior(),
                             media_->facets(place, surface));
      const bool is_rough = !is_specular(boundary.scattering.interface);
      if (is_rough && !surface.beyond && are_lamps_there)
        radiance += path.carried * search_beyond(boundary, point, light, samples);
      const BoundaryTurn turn = sample_turn(boundary, samples);
      if (turn.passes && !surface.beyond)
        return radiance +
               path.carried * (is_rough ? light_beyond(turn, point, light, samples)
                                        : light_outside(path, last, turn, point, light, samples));
      path.ray.direction = turn.direction;
      if (turn.passes) place.holders = surface.crossing.beyond;
    }
    path.ray.origin = leave_surface(point, path.ray.direction);
    path.has_scattered = false;
    path.safe = 0.0f;
    place = media_->place(place.holders, path.ray.origin);
  }
  return radiance;
}

template class MediaWalk<4>;
template class MediaWalk<8>;
template class MediaWalk<16>;

}  // namespace lamina
