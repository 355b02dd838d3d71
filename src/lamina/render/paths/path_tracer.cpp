// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/geometry/hemisphere.h"
#include "lamina/render/paths/internal/direct_light.h"
#include "lamina/render/paths/internal/path_step.h"

namespace lamina {
namespace {

constexpr int max_steps = 48;  // of one path, glass included

}  // namespace

template <int N>
class PathTracer<N>::Gatherer final : public LightGatherer<N> {
 public:
  Gatherer(const PathTracer& tracer, int bounce) : tracer_(tracer), bounce_(bounce) {}
  Bands entering_irradiance(const SurfacePoint& entry, PixelSamples& samples) const override {
    return tracer_.entering_light(entry, bounce_, samples, nullptr).irradiance;
  }
  Bands shadow_transmittance(const Ray& ray, float distance) const override {
    return tracer_.shadow_transmittance(ray, distance);
  }
  Bands arriving_radiance(const Ray& ray, PixelSamples& samples) const override {
    return tracer_.arriving_radiance(ray, bounce_, samples);
  }

 private:
  const PathTracer& tracer_;
  int bounce_;
};

template <int N>
BandValues<N> PathTracer<N>::clamp_indirect(Bands light, const PathState<N>& path) const {
  if (!path.is_scattered) return light;
  const float limit = 10.0f * world_.scene.lights.typical_irradiance() / float_pi;
  const float top = largest(light);
  return top > limit ? (limit / top) * light : light;
}

template <int N>
EnteringLight<N> PathTracer<N>::entering_light(const SurfacePoint& entry, int bounce,
                                               PixelSamples& samples,
                                               const SkyIrradiance* sky) const {
  const SurfaceBoundary boundary = boundary_at(world_.scene, entry);
  EnteringLight<N> found;
  Vec3f of_open_sky;
  const auto cover = cover_at(world_.scene, world_.coverings, entry);
  const auto pass = [&](float cos_i) {
    return cover ? cover->through(cos_i) : Bands::filled(1.0f);
  };
  const auto mis_weight = [&](const LightSample& light, float cos_i) {
    return mis_weight_of_light_sample(world_.options.direct_light, light, cos_i / float_pi);
  };
  const auto entering = [&](const LightSample& light) {
    const float cos_i = dot(light.direction, entry.normal);
    if (!(cos_i > 0.0f) || !(dot(light.direction, entry.geometric_normal) > 0.0f)) return 0.0f;
    return cos_i * (1.0f - reflectance(boundary, cos_i)) * mis_weight(light, cos_i);
  };
  // One light of each stratum: whether one is seen would be noise on what another gives.
  for (const LightStratum& stratum : world_.scene.lights.strata()) {
    const auto weighed = [&](const LightSample& light) {
      const float cos_i = dot(light.direction, entry.normal);
      // Below the horizon of the face no light enters, but that of an open sky has it.
      if (sky && is_sky(light) && cos_i > 0.0f &&
          !(dot(light.direction, entry.geometric_normal) > 0.0f)) {
        const Vec3f hidden = (sky->entering(cos_i) * mis_weight(light, cos_i) * stratum.size /
                              (light.pdf * static_cast<float>(stratum.candidates))) *
                             light.radiance;
        of_open_sky += hidden;
        found.open += hidden.x + hidden.y + hidden.z;
      }
      return entering(light);
    };
    const ResampledLight<N> drawn =
        resample_light(world_, entry, samples, weighed, Dielectrics::transmit, stratum);
    if (drawn.weight > 0.0f)
      found.irradiance += drawn.weight * entering(drawn.light) *
                          pass(dot(drawn.light.direction, entry.normal)) * drawn.transmittance *
                          world_.conversion.from_rgb(drawn.light.radiance);
    if (!sky || !(drawn.open_weight > 0.0f) || !is_sky(drawn.light)) continue;
    const float cos_i = dot(drawn.light.direction, entry.normal);
    const Vec3f open = (drawn.open_weight * sky->entering(cos_i) * mis_weight(drawn.light, cos_i)) *
                       drawn.light.radiance;
    of_open_sky += open;
    const float brightness = open.x + open.y + open.z;
    found.open += brightness;
    found.seen += brightness * largest(drawn.transmittance);
  }
  const Framef frame = make_frame(entry.normal);
  const Vec3f wi = sample_cosine_hemisphere(samples.next_2d());
  const Vec3f direction = frame.to_world(wi);
  const bool is_above = dot(direction, entry.geometric_normal) > 0.0f;
  const float pdf = wi.z / float_pi;
  if (wi.z > 0.0f && is_above) {
    found.irradiance += float_pi * (1.0f - reflectance(boundary, wi.z)) * pass(wi.z) *
                        trace_path({.ray = {leave_surface(entry, direction), direction},
                                    .bounce = bounce + 1,
                                    .pdf = pdf,
                                    .spread = 0.3f,
                                    .footprint = entry.footprint,
                                    .is_scattered = true},
                                   samples);
  }
  // What coverings return to the inside counts half where light enters, half where it leaves.
  Bands returning = Bands::filled(1.0f);
  if (const auto& method = world_.transports[entry.material]; cover && method)
    returning = sqrt(cover->returning(method->local_reflectance(entry)));
  found.irradiance = returning * found.irradiance;
  if (!sky) return found;
  if (wi.z > 0.0f)
    for_sky_seen(world_.scene.lights, direction, [&](const LightSeen& seen) {
      const float weight = mis_weight_of_surface_sample(world_.options.direct_light, pdf, seen.pdf,
                                                        light_candidates);
      of_open_sky += (weight * sky->entering(wi.z) / pdf) * seen.radiance;
    });
  found.missed = world_.conversion.from_rgb(sky->at(entry.normal) - of_open_sky);
  if (cover) found.missed = returning * cover->mean_through() * found.missed;
  return found;
}

template <int N>
bool PathTracer<N>::passes_straight(const SurfacePoint& point, PathState<N>& path,
                                    PixelSamples& samples) const {
  const ThinSheet<N>* sheet = world_.sheets[point.material].get();
  if (!sheet && !world_.scene.scene->materials[point.material].opacity) return false;
  const float opacity = opacity_at(world_.scene, point);
  Bands straight;
  if (sheet) straight = straight_through(world_.scene, *sheet, point, path.ray.direction);
  const float chance = 1.0f - opacity + opacity * std::min(largest(straight), 0.9f);
  if (samples.next_1d() < chance) {
    path.throughput *= (1.0f / chance) * (Bands::filled(1.0f - opacity) + opacity * straight);
    return true;
  }
  path.throughput *= opacity / (1.0f - chance);
  return false;
}

template <int N>
void PathTracer<N>::pass_unbent(const Hit& hit, const SurfacePoint& point,
                                const DielectricSurface& glass, PathState<N>& path,
                                PixelSamples& samples) const {
  const Vec3f wo = -path.ray.direction;
  const float cos_i = std::min(std::abs(dot(wo, point.smooth_normal)), 1.0f);
  if (samples.next_1d() < fresnel(cos_i, glass.ior)) {
    path.ray.direction = normalize(reflect(wo, point.smooth_normal));
    path.ray.origin = leave_surface(point, path.ray.direction);
    path.pdf = 0.0f;
    path.is_from_inside = false;
    path.t_near = 0.0f;
  } else {
    path.t_near = distance_behind(hit, point);
  }
}

template <int N>
void PathTracer<N>::add_lights_on_ray(float limit, PathState<N>& path) const {
  world_.scene.lights.for_lights_seen(path.ray, path.t_near, limit, path.is_camera_ray,
                                      [&](const LightSeen& seen) { add_light_seen(seen, path); });
}

template <int N>
void PathTracer<N>::add_light_seen(const LightSeen& seen, PathState<N>& path) const {
  const float left = path.is_from_inside ? 1.0f - seen.next_event_share : 1.0f;
  if (!(left > 0.0f)) return;
  const float weight = left *
                       mis_weight_of_surface_sample(world_.options.direct_light, path.pdf, seen.pdf,
                                                    path.candidates) /
                       (path.index * path.index);
  const Bands arriving = weight * path.throughput * world_.conversion.from_rgb(seen.radiance);
  const bool is_caustic = path.pdf == 0.0f && !path.is_from_inside;
  path.radiance += is_caustic ? clamp_indirect(arriving, path) : arriving;
}

template <int N>
bool PathTracer<N>::take_step(const SurfacePoint& point, PathState<N>& path, PixelSamples& samples,
                              CameraSample* first) const {
  const PathSurface<N> surface =
      make_path_surface(world_, point, -path.ray.direction, path.is_from_eye);
  const PathStep<N> step =
      make_path_step(world_, surface, path, Gatherer(*this, path.bounce), samples);
  const Bands inside = path.throughput * step.inside, base = path.throughput * step.base;
  const Bands specular = path.throughput * step.specular;
  path.radiance += inside;
  path.radiance += clamp_indirect(specular, path) + base;
  if (first) {
    first->albedo = world_.conversion.to_rgb(surface.reflectance());
    first->specular += world_.conversion.to_rgb(specular);
    first->is_subsurface = step.is_subsurface;
    if (step.is_subsurface) first->subsurface = world_.conversion.to_rgb(inside + base);
  }
  if (!step.continues) return false;
  path.ray = {leave_surface(surface.at.point, step.direction), step.direction};
  path.t_near = 0.0f;
  path.throughput *= step.weight;
  path.pdf = step.pdf;
  path.spread = step.spread;
  path.candidates = step.candidates;
  path.is_specular = step.is_specular;
  path.is_camera_ray = path.is_from_eye = path.is_from_inside = false;
  path.index = 1.0f;  // from here on glass bends and concentrates nothing
  path.is_scattered = path.is_scattered || path.pdf > 0.0f;
  ++path.bounce;
  return true;
}

template <int N>
BandValues<N> PathTracer<N>::trace_path(PathState<N> path, PixelSamples& samples,
                                        CameraSample* first) const {
  Vec3f* part = nullptr;  // of the camera's sample: what light beyond the first surface belongs to
  Bands before;           // radiance gathered up to that surface
  for (int step = 0; step < max_steps; ++step) {
    const Hit hit = world_.scene.geometry.first_hit(path.ray, path.t_near);
    add_lights_on_ray(hit.distance, path);
    if (!hit.is_hit()) break;
    const float footprint = path.footprint + path.spread * hit.distance;
    const SurfacePoint point = surface_at(world_.scene, hit, footprint);
    if (passes_straight(point, path, samples)) {
      path.t_near = distance_behind(hit, point);
      continue;
    }
    if (const auto seen = world_.scene.lights.surface_emission(
            point.material, point.geometric_normal, path.ray.direction, hit.distance))
      add_light_seen(*seen, path);
    if (path.is_camera_ray && first) {
      first->depth = hit.distance;
      first->is_hit = true;
      first->normal = point.normal;
      first->mesh = point.mesh;
      first->material = point.material;
    }
    const auto& material = world_.scene.scene->materials[point.material];
    if (const auto* glass = std::get_if<DielectricSurface>(&material.surface)) {
      if (!path.is_from_eye) {
        pass_unbent(hit, point, *glass, path, samples);
        continue;
      }
      if (!scatter_at_dielectric(world_, point, *glass, path, samples)) break;
      path.footprint = footprint;
      continue;
    }
    if (path.bounce > world_.options.max_bounces) break;
    path.footprint = footprint;
    CameraSample* const seen = path.is_from_eye ? first : nullptr;
    if (!take_step(point, path, samples, seen)) break;
    if (seen) {
      part = path.is_specular ? &seen->specular : seen->is_subsurface ? &seen->subsurface : nullptr;
      before = path.radiance;
    }
    // Russian roulette: a dim path is continued seldom, and then counts for those that ended.
    if (path.bounce > 1) {
      const float continuation = std::min(1.0f, largest(path.throughput));
      if (!(samples.next_1d() < continuation)) break;
      path.throughput *= 1.0f / continuation;
    }
  }
  if (part) *part += world_.conversion.to_rgb(path.radiance - before);
  return path.radiance;
}

template <int N>
CameraSample PathTracer<N>::trace_camera_ray(const Ray& ray, float spread,
                                             PixelSamples& samples) const {
  CameraSample sample;
  const PathState<N> path{.ray = ray, .spread = spread, .is_camera_ray = true, .is_from_eye = true};
  sample.beauty = world_.conversion.to_rgb(trace_path(path, samples, &sample));
  return sample;
}

template class PathTracer<4>;
template class PathTracer<8>;
template class PathTracer<16>;

}  // namespace lamina
