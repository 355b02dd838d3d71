// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/optics/fresnel.h"
#include "lamina/render/paths/internal/direct_light.h"
#include "lamina/render/paths/internal/path_step.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int max_steps = 48;  // of one path, glass included

}  // namespace

template <int N>
class PathTracer<N>::Gatherer final : public LightGatherer<N> {
 public:
  Gatherer(const PathTracer& tracer, int bounce) : tracer_(tracer), bounce_(bounce) {}
  Bands entering_irradiance(const SurfacePoint& entry, PixelSamples& samples) const override {
    return tracer_.entering_irradiance(entry, bounce_, samples);
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
BandValues<N> PathTracer<N>::clamp_indirect(Bands light, const Path& path) const {
  if (!path.is_scattered) return light;
  const float limit = 10.0f * world_.scene.lights.typical_irradiance() / pi;
  const float top = largest(light);
  return top > limit ? (limit / top) * light : light;
}

template <int N>
BandValues<N> PathTracer<N>::entering_irradiance(const SurfacePoint& entry, int bounce,
                                                 PixelSamples& samples) const {
  const SurfaceBoundary boundary = boundary_at(world_.scene, entry);
  Bands irradiance;
  const auto entering = [&](const LightSample& light) {
    const float cos_i = dot(light.direction, entry.normal);
    if (!(cos_i > 0.0f) || !(dot(light.direction, entry.geometric_normal) > 0.0f)) return 0.0f;
    return cos_i * (1.0f - reflectance(boundary, cos_i)) *
           mis_weight_of_light_sample(world_.options.direct_light, light, cos_i / pi);
  };
  // One light of each share: whether one is seen would be noise on what another gives.
  for (const LightStratum& share : world_.scene.lights.strata()) {
    const ResampledLight<N> drawn =
        resample_light(world_, entry, samples, entering, Dielectrics::transmit, share);
    if (drawn.weight > 0.0f)
      irradiance += drawn.weight * entering(drawn.light) * drawn.clear *
                    world_.conversion.from_rgb(drawn.light.radiance);
  }
  const Framef frame = make_frame(entry.normal);
  const Vec3f wi = sample_cosine_hemisphere(samples.next_2d());
  const Vec3f direction = frame.to_world(wi);
  if (wi.z > 0.0f && dot(direction, entry.geometric_normal) > 0.0f) {
    const Path path{.bounce = bounce + 1,
                    .pdf = wi.z / pi,
                    .spread = 0.3f,
                    .footprint = entry.footprint,
                    .is_scattered = true};
    irradiance += pi * (1.0f - reflectance(boundary, wi.z)) *
                  follow({leave_surface(entry, direction), direction}, path, samples, nullptr);
  }
  return irradiance;
}

template <int N>
bool PathTracer<N>::passes(const SurfacePoint& point, const Ray& ray, Bands& throughput,
                           PixelSamples& samples) const {
  const ThinSheet<N>* sheet = world_.sheets[point.material].get();
  if (!sheet && !world_.scene.scene->materials[point.material].opacity) return false;
  const float opacity = opacity_at(world_.scene, point);
  Bands straight;
  if (sheet) straight = straight_through(world_.scene, *sheet, point, ray.direction);
  const float chance = 1.0f - opacity + opacity * std::min(largest(straight), 0.9f);
  if (samples.next_1d() < chance) {
    throughput *= (1.0f / chance) * (Bands::filled(1.0f - opacity) + opacity * straight);
    return true;
  }
  throughput *= opacity / (1.0f - chance);
  return false;
}

template <int N>
BandValues<N> PathTracer<N>::follow(Ray ray, Path path, PixelSamples& samples,
                                    CameraSample* first) const {
  Bands radiance, throughput = Bands::filled(1.0f);
  Bands before_turn;  // what had come home when the path turned at the first surface
  bool is_mirrored = false, is_from_layers = false;
  float t_near = 0.0f;
  for (int step = 0; step < max_steps; ++step) {
    const Hit hit = world_.scene.geometry.first_hit(ray, t_near);
    world_.scene.lights.for_lights_seen(
        ray, t_near, hit.distance, path.is_camera_ray, [&](const LightSeen& seen) {
          const float left = path.is_from_inside ? 1.0f - seen.next_event_share : 1.0f;
          if (!(left > 0.0f)) return;
          const float weight = left *
                               mis_weight_of_surface_sample(world_.options.direct_light, path.pdf,
                                                            seen.pdf, path.candidates) /
                               (path.index * path.index);
          const Bands arriving = weight * throughput * world_.conversion.from_rgb(seen.radiance);
          const bool is_caustic = path.pdf == 0.0f && !path.is_from_inside;
          radiance += is_caustic ? clamp_indirect(arriving, path) : arriving;
        });
    if (!hit.is_hit()) break;
    const float footprint = path.footprint + path.spread * hit.distance;
    const SurfacePoint point = surface_at(world_.scene, hit, footprint);
    if (passes(point, ray, throughput, samples)) {
      t_near = distance_behind(hit, point);
      continue;
    }
    if (path.is_camera_ray && first) {
      first->depth = hit.distance;
      first->is_hit = true;
      first->normal = point.normal;
    }
    const auto& material = world_.scene.scene->materials[point.material];
    if (const auto* glass = std::get_if<DielectricSurface>(&material.surface)) {
      if (path.is_from_eye) {
        if (!scatter_at_dielectric(world_, point, *glass, ray, path, throughput, radiance, samples))
          break;
        path.footprint = footprint;
        t_near = 0.0f;
        continue;
      }
      // Light on other surfaces passes glass straight, as in shadow_transmittance, or is mirrored.
      const float cos_i = std::min(std::abs(dot(ray.direction, point.smooth_normal)), 1.0f);
      if (samples.next_1d() < fresnel(cos_i, glass->ior)) {
        ray.direction = normalize(reflect(-ray.direction, point.smooth_normal));
        ray.origin = leave_surface(point, ray.direction);
        path.pdf = 0.0f;
        path.is_from_inside = false;
        t_near = 0.0f;
      } else {
        t_near = distance_behind(hit, point);
      }
      continue;
    }
    if (path.bounce > world_.options.max_bounces) break;

    const PathSurface<N> surface = make_path_surface(world_, point, -ray.direction);
    const bool is_first = path.is_from_eye && first;
    path.footprint = footprint;
    bool goes_on = true, is_specular = false;
    if (is_first) first->albedo = world_.conversion.to_rgb(surface.reflectance);
    if (path.is_from_eye && surface.transport) {
      const ExitPoint exit{surface.point, surface.boundary, surface.wo.z, -ray.direction};
      const Bands inside = throughput * surface.transport->leaving_radiance(
                                            exit, Gatherer(*this, path.bounce), samples);
      radiance += inside;
      if (is_first) {
        first->is_subsurface = true;
        first->subsurface = world_.conversion.to_rgb(inside);
      }
      if (surface.boundary.count == 0) break;
      const Bands mirrored =
          throughput * direct_light(world_, surface, false, 1.0f, 0.0f, samples).specular;
      radiance += mirrored;
      if (is_first) first->specular += world_.conversion.to_rgb(mirrored);
      const SpecularSample sample =
          sample_specular(surface.boundary, surface.wo, samples.next_1d(), samples.next_2d());
      goes_on = sample.weight > 0.0f;
      is_specular = true;
      if (goes_on) {
        throughput *= sample.weight;
        path.pdf = sample.is_mirror ? 0.0f : sample.pdf;
        path.candidates = specular_light_candidates(world_);
        path.spread = std::max(path.spread, sample.is_mirror ? 0.0f : 0.1f);
        ray.direction = surface.frame.to_world(sample.wi);
        goes_on = dot(ray.direction, surface.point.geometric_normal) > 0.0f;
        ray.origin = leave_surface(surface.point, ray.direction);
      }
    } else {
      const float chance = specular_chance(surface);
      const Reflected<N> direct =
          direct_light(world_, surface, true, chance, 1.0f - chance, samples);
      radiance += clamp_indirect(throughput * direct.specular, path) + throughput * direct.base;
      if (is_first) first->specular += world_.conversion.to_rgb(throughput * direct.specular);
      if (is_first && surface.layered) {
        first->is_subsurface = true;
        first->subsurface = world_.conversion.to_rgb(throughput * direct.base);
      }
      goes_on = scatter(surface, chance, ray, path, throughput, is_specular, samples);
      path.candidates = light_candidates;
    }
    if (!goes_on) break;
    if (is_first) {
      is_mirrored = is_specular;
      is_from_layers = !is_specular && surface.layered;
      before_turn = radiance;
    }
    path.is_camera_ray = path.is_from_eye = false;
    path.is_from_inside = false;
    path.index = 1.0f;  // from here on glass bends and concentrates nothing
    path.is_scattered = path.is_scattered || path.pdf > 0.0f;
    ++path.bounce;
    t_near = 0.0f;
    // Russian roulette: a dim path goes on seldom, and then counts for those that did not.
    if (path.bounce > 1) {
      const float survival = std::min(1.0f, largest(throughput));
      if (!(samples.next_1d() < survival)) break;
      throughput *= 1.0f / survival;
    }
  }
  if (is_mirrored) first->specular += world_.conversion.to_rgb(radiance - before_turn);
  if (is_from_layers) first->subsurface += world_.conversion.to_rgb(radiance - before_turn);
  return radiance;
}

template <int N>
CameraSample PathTracer<N>::trace_camera_ray(const Ray& ray, float spread,
                                             PixelSamples& samples) const {
  CameraSample sample;
  const Path path{.spread = spread, .is_camera_ray = true, .is_from_eye = true};
  sample.beauty = world_.conversion.to_rgb(follow(ray, path, samples, &sample));
  return sample;
}

template class PathTracer<4>;
template class PathTracer<8>;
template class PathTracer<16>;

}  // namespace lamina
