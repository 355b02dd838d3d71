// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/media_walk.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "lamina/core/error.h"

namespace lamina {
namespace {

constexpr int most_turns = 200'000, most_bodies = 1000;  // of a path; on one way
constexpr std::uint32_t walks = 4;                       // from where a ray of the eye enters
constexpr float least_search = 0.05f;

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
  const BodyMedium<N>* own = media_->of_material(material);
  if (!own) return;
  reflectance_ = own->layers.diffuse_reflectance();
  const std::size_t last = own->layers.by_depth().count() - 1;
  const bool has_points = std::ranges::any_of(scene.lights, [](const Light& light) {
    return std::holds_alternative<PointLight>(light) ||
           std::holds_alternative<DirectionalLight>(light);
  });
  if (!own->layers.sees_out(last) && has_points)
    throw InvalidInput("material \"" + scene.materials[material].name +
                       "\": random_walk does not " +
                       "find point and distant lights through layers of different ior; use " +
                       "rectangles, or one ior");
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
    const std::size_t first = place.depth.layer;
    const Ray rest{path.ray.origin + begin * path.ray.direction, path.ray.direction};
    layers.by_depth().for_parts(rest, place.depth, std::min(surface.hit.distance, reach) - begin,
                                [&](std::size_t layer, float part) {
                                  if (layers.own_ior(layer) != layers.own_ior(first)) {
                                    step = {Step::End::layer, {}, layer};
                                    return false;
                                  }
                                  place.depth.layer = layer;
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
    if (step.end == Step::End::layer) {
      path.ray.origin += end * path.ray.direction;
      break;
    }
    if (!surface.hit.is_hit()) return {};
    if (!surface.passes) {
      step = {Step::End::surface, surface};
      break;
    }
    begin = surface.hit.distance;
    t_near = distance_behind(surface.hit, surface.point);
    place = surface.beyond;
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
void MediaWalk<N>::start_anew(WalkPath<N>& path, Place& place) const {
  path.has_scattered = false;
  path.safe = 0.0f;
  place = media_->place(place.holders, path.ray.origin);
}

template <int N>
void MediaWalk<N>::meet_layer(WalkPath<N>& path, Place& place, std::size_t next,
                              PixelSamples& samples) const {
  const WalkLayers<N>& layers = place.medium->layers;
  const Vec3f outward = layers.by_depth().outward(path.ray.origin);
  const SurfacePoint point{.position = path.ray.origin,
                           .geometric_normal = outward,
                           .smooth_normal = outward,
                           .normal = outward};
  const std::size_t here = place.depth.layer, deeper = std::max(here, next);
  const WalkBoundary boundary =
      make_walk_boundary(point, path.ray.direction, layers.own_ior(next) / layers.own_ior(here),
                         layers.boundary(deeper));
  const BoundaryTurn turn = sample_turn(boundary, samples);
  path.ray.direction = turn.direction;
  const bool goes_deeper = (turn.passes ? next : here) == deeper;
  const float nudge = layers.by_depth().nudge(path.ray.origin);
  path.ray.origin += (goes_deeper ? -nudge : nudge) * outward;
  start_anew(path, place);
}

template <int N>
BandValues<N> MediaWalk<N>::walk(const ExitPoint& exit, const LightGatherer<N>& light,
                                 PixelSamples& samples) const {
  const WalkBodies::Crossing entry = media_->bodies().cross({}, exit.point, -exit.to_eye);
  Place place = media_->place(entry.beyond, exit.point.position);
  if (entry.is_blocked || !place.medium) return {};
  const Vec3f inward = sample_entry(exit.to_eye, exit.point.normal, place.medium->layers.ior(),
                                    place.medium->layers.boundary(0), samples);
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
          are_lamps_there && !place.medium->is_rough && layers.sees_out(place.depth.layer)
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
    if (step.end == Step::End::layer) {
      meet_layer(path, place, step.layer, samples);
      continue;
    }
    const Surface& surface = step.surface;
    const SurfacePoint& point = surface.point;
    if (surface.crossing.is_blocked) {
      place.medium->space.bounce(path, point, surface.hit, numbers.pair());
    } else {
      const BodyMedium<N>* beyond = surface.beyond.medium;
      const float eta = beyond ? beyond->layers.own_ior(surface.beyond.depth.layer) /
                                     layers.own_ior(place.depth.layer)
                               : 1.0f / layers.ior();
      const WalkBoundary boundary =
          make_walk_boundary(point, path.ray.direction, eta, media_->facets(place, surface));
      const bool is_rough = !is_specular(boundary.scattering.interface);
      if (is_rough && !beyond && are_lamps_there)
        radiance += path.carried * search_beyond(boundary, point, light, samples);
      const BoundaryTurn turn = sample_turn(boundary, samples);
      if (turn.passes && !beyond)
        return radiance +
               path.carried * (is_rough ? light_beyond(turn, point, light, samples)
                                        : light_outside(path, last, turn, point, light, samples));
      path.ray.direction = turn.direction;
      if (turn.passes) place.holders = surface.crossing.beyond;
    }
    path.ray.origin = leave_surface(point, path.ray.direction);
    start_anew(path, place);
  }
  return radiance;
}

template class MediaWalk<4>;
template class MediaWalk<8>;
template class MediaWalk<16>;

}  // namespace lamina
