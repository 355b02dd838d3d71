// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/optics/fresnel.h"
#include "lamina/render/dielectric_scattering.h"

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int max_steps = 48;  // of one path, glass included

/// Directions to lights are drawn by the handful, weighed without shadows, and one of them traced.
constexpr int light_candidates = 4;

/// What a surface makes of light from one direction.
struct Lobes {
  float specular = 0.0f, base = 0.0f;  ///< BRDFs [1/sr], base for a reflectance of 1
  float scale = 0.0f;                  ///< cosine, and share among the ways to draw the direction
};

/// A direction around +z with density cos / pi.
Vec3f draw_cosine(Vec2f u) {
  // Concentric map of the square to the disc: it keeps the strata of the samples compact.
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  float r = 0.0f, phi = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    r = a;
    phi = 0.25f * pi * (b / a);
  } else if (b != 0.0f) {
    r = b;
    phi = 0.5f * pi - 0.25f * pi * (a / b);
  }
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - r * r))};
}

/// The normal turned so far towards the eye that it is seen.
Vec3f make_visible(const Vec3f& n, const Vec3f& wo) {
  constexpr float least = 0.02f;
  const float cos_o = dot(n, wo);
  return cos_o >= least ? n : normalize(n + (least - cos_o) * wo);
}

float square(float x) { return x * x; }

/// Whether a direction lies on the same side of the triangle as of the normal that is bent by
/// interpolation and bumps. `point` has its normals on the side of the eye.
bool leaves_by_its_side(const SurfacePoint& point, const Vec3f& direction, const Vec3f& local) {
  return local.z * dot(direction, point.geometric_normal) > 0.0f;
}

}  // namespace

template <int N>
class PathTracer<N>::Gatherer final : public LightGatherer<N> {
 public:
  Gatherer(const PathTracer& tracer, int bounce) : tracer_(tracer), bounce_(bounce) {}
  Bands entering_irradiance(const SurfacePoint& entry, PixelSamples& samples) const override {
    return tracer_.entering_irradiance(entry, bounce_, samples);
  }
  Bands clear_fraction(const Ray& ray, float distance) const override {
    return tracer_.clear_fraction(ray, distance);
  }
  Bands arriving_radiance(const Ray& ray, PixelSamples& samples) const override {
    return tracer_.arriving_radiance(ray, bounce_, samples);
  }

 private:
  const PathTracer& tracer_;
  int bounce_;
};

template <int N>
float PathTracer<N>::weight_of_surface_sample(float pdf, float pdf_light) const {
  if (pdf == 0.0f || pdf_light == 0.0f) return 1.0f;  // the light sampling cannot find it
  if (options_.direct_light == DirectLight::surfaces_only) return 1.0f;
  if (options_.direct_light == DirectLight::lights_only) return 0.0f;
  return square(pdf) / (square(pdf) + square(light_candidates * pdf_light));  // the power heuristic
}

template <int N>
BandValues<N> PathTracer<N>::without_caustics(Bands light, const Path& path) const {
  if (!path.is_scattered) return light;
  const float limit = 10.0f * scene_.lights.typical_irradiance() / pi;
  const float top = largest(light);
  return top > limit ? (limit / top) * light : light;
}

template <int N>
float PathTracer<N>::weight_of_light_sample(const LightSample& light, float pdf) const {
  if (light.is_delta || options_.direct_light == DirectLight::lights_only) return 1.0f;
  if (options_.direct_light == DirectLight::surfaces_only) return 0.0f;
  const float pdf_light = light_candidates * light.pdf;
  return square(pdf_light) / (square(pdf) + square(pdf_light));
}

template <int N>
template <class Value>
typename PathTracer<N>::LightDrawn PathTracer<N>::draw_light(const SurfacePoint& point,
                                                             PixelSamples& samples,
                                                             const Value& value,
                                                             Dielectrics dielectrics) const {
  const float u_light = samples.next_1d();
  const Vec2f u = samples.next_2d();
  const auto fraction = [](float x) { return x - std::floor(x); };
  LightDrawn chosen;
  float total = 0.0f, chosen_brightness = 0.0f, u_left = samples.next_1d();
  for (int i = 0; i < light_candidates; ++i) {
    // A lattice of candidates, moved as one: [Roberts2018]'s R2 sequence.
    const auto k = static_cast<float>(i);
    const LightSample light = scene_.lights.sample_light(
        point.position, fraction(u_light + k / light_candidates),
        {fraction(u.x + 0.7548777f * k), fraction(u.y + 0.5698403f * k)});
    if (!(light.pdf > 0.0f)) continue;
    const float brightness =
        (light.radiance.x + light.radiance.y + light.radiance.z) * value(light) / light.pdf;
    if (!(brightness > 0.0f)) continue;
    total += brightness;
    const float chance = brightness / total;
    if (u_left < chance) {
      u_left /= chance;
      chosen.light = light;
      chosen_brightness = brightness;
    } else {
      u_left = (u_left - chance) / std::max(1.0f - chance, 1e-9f);
    }
  }
  if (!(total > 0.0f)) return chosen;
  const LightSample& light = chosen.light;
  const Ray ray{leave_surface(point, light.direction), light.direction};
  chosen.clear =
      lamina::clear_fraction(scene_, sheets_, ray, 0.9999f * light.distance, dielectrics);
  if (largest(chosen.clear) > 0.0f)
    chosen.weight = total / (chosen_brightness * light.pdf * light_candidates);
  return chosen;
}

template <int N>
typename PathTracer<N>::Surface PathTracer<N>::make_surface(const SurfacePoint& point,
                                                            const Vec3f& towards_eye) const {
  const ThinSheet<N>* sheet = sheets_[point.material].get();
  const bool is_inside = dot(point.geometric_normal, towards_eye) < 0.0f;
  Surface surface{.point = point, .boundary = boundary_at(scene_, point, sheet && is_inside)};
  SurfacePoint& p = surface.point;
  if (is_inside) {
    p.geometric_normal = -p.geometric_normal;
    p.smooth_normal = -p.smooth_normal;
    p.normal = -p.normal;
  }
  p.normal = make_visible(p.normal, towards_eye);
  surface.frame = make_frame(p.normal);
  surface.wo = surface.frame.to_local(towards_eye);
  const auto& material = scene_.scene->materials[p.material];
  const auto color_of = [&](const ColorParameter& parameter) {
    const Vec3f c = scene_.textures.color(parameter, p);
    return conversion_.from_rgb(
        {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)});
  };
  if (const auto* diffuse = std::get_if<DiffuseSurface>(&material.surface)) {
    surface.reflectance = color_of(diffuse->color);
  } else if (sheet) {
    surface.sheet = sheet;
    surface.place = sheet->place_at(scene_.textures, p);
    surface.side = is_inside ? 1 : 0;
    surface.color = color_of(std::get<ThinSurface>(material.surface).color);
    surface.beyond = boundary_at(scene_, point, !is_inside);
    const auto at = sheet->fractions(surface.place, surface.side, surface.wo.z);
    surface.reflectance = surface.color * at.reflected;
    surface.transmittance = surface.color * at.transmitted;
  } else if (const auto* transport = transports_[p.material].get()) {
    surface.reflectance = transport->local_reflectance(p);
    if (!is_inside) surface.transport = transport;  // the inner side of an open mesh is diffuse
  } else if (const auto* layered = layered_[p.material].get()) {
    surface.layered = layered->at(p, surface.boundary, surface.wo);
    surface.reflectance = surface.layered->reflectance();
    surface.mirrored = surface.layered->mirrored_inside();
    const float mirrored = sum(surface.mirrored);
    surface.mirrored_chance = mirrored / (mirrored + sum(surface.reflectance) + 1e-6f);
  }
  return surface;
}

template <int N>
float PathTracer<N>::base_lobe(const Surface& surface, const Vec3f& wi) {
  if (wi.z < 0.0f && !surface.sheet) return 0.0f;
  if (surface.layered) return 1.0f / pi;  // to weigh lights; the bsdf itself is not for that
  const float entering =
      1.0f - reflectance(wi.z > 0.0f ? surface.boundary : surface.beyond, std::abs(wi.z));
  return entering * exit_distribution(surface.boundary, surface.wo.z);
}

template <int N>
BandValues<N> PathTracer<N>::base_color(const Surface& surface, const Vec3f& wi) {
  if (!surface.sheet) return surface.reflectance;
  const float cos_o = surface.wo.z;
  return surface.color *
         (wi.z > 0.0f ? surface.sheet->reflection(surface.place, surface.side, wi.z, cos_o)
                      : surface.sheet->transmission(surface.place, 1 - surface.side, -wi.z, cos_o));
}

template <int N>
float PathTracer<N>::pdf_base(const Surface& surface, const Vec3f& wi) {
  const float beyond = surface.beyond_chance();
  return (wi.z > 0.0f ? 1.0f - beyond : beyond) * std::abs(wi.z) / pi;
}

template <int N>
typename PathTracer<N>::Reflected PathTracer<N>::direct_light(const Surface& surface,
                                                              bool with_base, float specular_chance,
                                                              float base_chance,
                                                              PixelSamples& samples) const {
  const auto reflected = [&](const LightSample& light) {
    const Vec3f wi = surface.frame.to_local(light.direction);
    Lobes lobes;
    if (!leaves_by_its_side(surface.point, light.direction, wi)) return lobes;
    lobes.specular = specular_brdf(surface.boundary, wi, surface.wo);
    if (with_base) lobes.base = base_lobe(surface, wi);
    if (!(lobes.specular + lobes.base > 0.0f)) return lobes;
    float pdf = base_chance * pdf_base(surface, wi);
    if (lobes.specular > 0.0f && !light.is_delta)
      pdf += specular_chance * pdf_specular(surface.boundary, surface.wo, wi);
    lobes.scale = std::abs(wi.z) * weight_of_light_sample(light, pdf);
    return lobes;
  };
  const float brightness = with_base ? sum(surface.reflectance) / N : 0.0f;
  const float brightness_beyond = with_base ? sum(surface.transmittance) / N : 0.0f;
  const LightDrawn drawn = draw_light(surface.point, samples, [&](const LightSample& light) {
    const Lobes lobes = reflected(light);
    const bool is_beyond = dot(light.direction, surface.frame.z) < 0.0f;
    return lobes.scale *
           (lobes.specular + (is_beyond ? brightness_beyond : brightness) * lobes.base);
  });
  if (!(drawn.weight > 0.0f)) return {};
  Lobes lobes = reflected(drawn.light);
  const Vec3f wi = surface.frame.to_local(drawn.light.direction);
  if (surface.layered && with_base) {
    const auto value = surface.layered->evaluate(wi, samples);
    float pdf = base_chance * (1.0f - surface.mirrored_chance) * value.pdf;
    if (lobes.specular > 0.0f)
      pdf += specular_chance * pdf_specular(surface.boundary, surface.wo, wi);
    const float scale = wi.z * weight_of_light_sample(drawn.light, pdf);
    const Bands arriving =
        drawn.weight * scale * drawn.clear * conversion_.from_rgb(drawn.light.radiance);
    return {.specular = lobes.specular * arriving, .base = value.bsdf * arriving};
  }
  const Bands arriving =
      drawn.weight * lobes.scale * drawn.clear * conversion_.from_rgb(drawn.light.radiance);
  return {.specular = lobes.specular * arriving,
          .base = lobes.base * base_color(surface, wi) * arriving};
}

template <int N>
BandValues<N> PathTracer<N>::entering_irradiance(const SurfacePoint& entry, int bounce,
                                                 PixelSamples& samples) const {
  const SurfaceBoundary boundary = boundary_at(scene_, entry);
  Bands irradiance;
  const auto entering = [&](const LightSample& light) {
    const float cos_i = dot(light.direction, entry.normal);
    if (!(cos_i > 0.0f) || !(dot(light.direction, entry.geometric_normal) > 0.0f)) return 0.0f;
    return cos_i * (1.0f - reflectance(boundary, cos_i)) *
           weight_of_light_sample(light, cos_i / pi);
  };
  const LightDrawn drawn = draw_light(entry, samples, entering);
  if (drawn.weight > 0.0f)
    irradiance += drawn.weight * entering(drawn.light) * drawn.clear *
                  conversion_.from_rgb(drawn.light.radiance);
  const Framef frame = make_frame(entry.normal);
  const Vec3f wi = draw_cosine(samples.next_2d());
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
float PathTracer<N>::specular_chance(const Surface& surface) {
  if (surface.boundary.count == 0) return 0.0f;
  const float mirrored = reflectance(surface.boundary, surface.wo.z);
  const float base = (1.0f - mirrored) * largest(surface.reflectance + surface.transmittance);
  return std::clamp(mirrored / (mirrored + base + 1e-6f), 0.1f, 0.9f);
}

template <int N>
bool PathTracer<N>::scatter(const Surface& surface, float chance, Ray& ray, Path& path,
                            Bands& throughput, bool& is_specular, PixelSamples& samples) const {
  const float u = samples.next_1d();
  const Vec2f u2 = samples.next_2d();
  is_specular = u < chance;
  Vec3f wi;
  std::optional<typename LayeredPoint<N>::Value> layered;
  if (is_specular) {
    const SpecularSample sample = sample_specular(surface.boundary, surface.wo, u / chance, u2);
    if (!(sample.weight > 0.0f)) return false;
    wi = sample.wi;
    if (sample.is_mirror) {
      throughput *= sample.weight / chance;
      path.pdf = 0.0f;
    }
    path.spread = std::max(path.spread, sample.is_mirror ? 0.0f : 0.1f);
    if (!sample.is_mirror) path.pdf = sample.pdf;
  } else if (surface.layered) {
    const float mirrored = surface.mirrored_chance;
    float v = (u - chance) / (1.0f - chance);
    path.spread = v < mirrored ? path.spread : 0.3f;
    path.pdf = v < mirrored ? 0.0f : 1.0f;
    if (v < mirrored) {
      wi = {-surface.wo.x, -surface.wo.y, surface.wo.z};
      throughput *= (1.0f / (mirrored * (1.0f - chance))) * surface.mirrored;
    } else {
      v = (v - mirrored) / (1.0f - mirrored);
      const auto drawn = surface.layered->sample(std::min(v, 0x1.fffffep-1f), u2, samples);
      if (!(drawn.value.pdf > 0.0f)) return false;
      wi = drawn.wi;
      layered = drawn.value;
    }
  } else {
    wi = draw_cosine(u2);
    if (u - chance < (1.0f - chance) * surface.beyond_chance()) wi.z = -wi.z;
    path.pdf = 1.0f;
    path.spread = 0.3f;
  }
  ray.direction = surface.frame.to_world(wi);
  if (!leaves_by_its_side(surface.point, ray.direction, wi)) return false;
  if (path.pdf > 0.0f && surface.layered) {
    const bool is_from_base = layered.has_value();
    if (!layered) layered = surface.layered->evaluate(wi, samples);
    const float of_base = (1.0f - chance) * (1.0f - surface.mirrored_chance) * layered->pdf;
    const float of_mirror =
        chance > 0.0f ? chance * pdf_specular(surface.boundary, surface.wo, wi) : 0.0f;
    path.pdf = of_base + of_mirror;
    if (!(path.pdf > 0.0f)) return false;
    const Bands mirrored = Bands::filled(specular_brdf(surface.boundary, wi, surface.wo));
    if (!surface.layered->is_random())
      throughput *= (wi.z / path.pdf) * (layered->bsdf + mirrored);
    else if (is_from_base)
      throughput *= (wi.z / of_base) * layered->bsdf;
    else
      throughput *= (wi.z / of_mirror) * mirrored;
  } else if (path.pdf > 0.0f) {
    // All lobes may give this direction, so all count.
    path.pdf = (1.0f - chance) * pdf_base(surface, wi) +
               (chance > 0.0f ? chance * pdf_specular(surface.boundary, surface.wo, wi) : 0.0f);
    throughput *= (std::abs(wi.z) / path.pdf) *
                  (base_lobe(surface, wi) * base_color(surface, wi) +
                   Bands::filled(specular_brdf(surface.boundary, wi, surface.wo)));
  }
  ray.origin = leave_surface(surface.point, ray.direction);
  return true;
}

template <int N>
bool PathTracer<N>::pass_dielectric(const SurfacePoint& point, const DielectricSurface& glass,
                                    Ray& ray, Path& path, Bands& throughput, Bands& radiance,
                                    PixelSamples& samples) const {
  const bool is_inside = dot(ray.direction, point.geometric_normal) > 0.0f;
  const Vec3f n = make_visible(is_inside ? -point.normal : point.normal, -ray.direction);
  const Framef frame = make_frame(n);
  const Vec3f wo = frame.to_local(-ray.direction);
  const DielectricScattering boundary = dielectric_at(scene_.textures, glass, point, is_inside);
  const auto index_towards = [&](const Vec3f& direction) {
    return dot(direction, point.geometric_normal) < 0.0f ? glass.ior : 1.0f;
  };
  // Radiance over n^2 is what paths carry: glass passes it unchanged.
  if (!is_specular(boundary.interface)) {
    const auto pdf = [&](const LightSample& light) {
      const Vec3f wi = frame.to_local(light.direction);
      const float side = dot(light.direction, point.geometric_normal) * (is_inside ? -1.0f : 1.0f);
      return wi.z * side > 0.0f ? pdf_dielectric(boundary, wo, wi) : 0.0f;
    };
    // Lights behind another glass are found by paths that are refracted there.
    const LightDrawn drawn = draw_light(
        point, samples,
        [&](const LightSample& light) {
          const float density = pdf(light);
          return density * weight_of_light_sample(light, density);
        },
        Dielectrics::block);
    if (drawn.weight > 0.0f) {
      const LightSample& light = drawn.light;
      const float value =
          evaluate_dielectric(boundary, wo, frame.to_local(light.direction), samples) *
          weight_of_light_sample(light, pdf(light)) / square(index_towards(light.direction));
      radiance +=
          value * drawn.weight * throughput * drawn.clear * conversion_.from_rgb(light.radiance);
    }
  }
  const DielectricSample sample = sample_dielectric(boundary, wo, samples);
  if (!(sample.weight > 0.0f)) return false;
  throughput *= sample.weight;
  ray.direction = normalize(frame.to_world(sample.wi));
  ray.origin = leave_surface(point, ray.direction);
  path.pdf = sample.pdf;
  path.index = index_towards(ray.direction);
  if (sample.pdf > 0.0f)
    path.spread = std::max(
        path.spread, 0.3f * std::min(static_cast<float>(boundary.interface.facets.alpha), 1.0f));
  path.is_camera_ray = false;
  return true;
}

template <int N>
bool PathTracer<N>::passes(const SurfacePoint& point, const Ray& ray, Bands& throughput,
                           PixelSamples& samples) const {
  const ThinSheet<N>* sheet = sheets_[point.material].get();
  if (!sheet && !scene_.scene->materials[point.material].opacity) return false;
  const float opacity = opacity_at(scene_, point);
  Bands straight;
  if (sheet) straight = straight_through(scene_, *sheet, point, ray.direction);
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
    const Hit hit = scene_.geometry.first_hit(ray, t_near);
    scene_.lights.for_lights_seen(
        ray, t_near, hit.distance, path.is_camera_ray, [&](const LightSeen& seen) {
          if (seen.is_lamp && !path.sees_lamps) return;
          const float weight = weight_of_surface_sample(path.pdf, seen.pdf) / square(path.index);
          const Bands arriving = weight * throughput * conversion_.from_rgb(seen.radiance);
          radiance += path.pdf == 0.0f ? without_caustics(arriving, path) : arriving;
        });
    if (!hit.is_hit()) break;
    const float footprint = path.footprint + path.spread * hit.distance;
    const SurfacePoint point = surface_at(scene_, hit, footprint);
    if (passes(point, ray, throughput, samples)) {
      t_near = behind(hit, point);
      continue;
    }
    if (path.is_camera_ray && first) {
      first->depth = hit.distance;
      first->is_hit = true;
      first->normal = point.normal;
    }
    const auto& material = scene_.scene->materials[point.material];
    if (const auto* glass = std::get_if<DielectricSurface>(&material.surface)) {
      if (path.is_from_eye) {
        if (!pass_dielectric(point, *glass, ray, path, throughput, radiance, samples)) break;
        path.footprint = footprint;
        t_near = 0.0f;
        continue;
      }
      // Light on other surfaces passes glass straight, as in clear_fraction, or is mirrored.
      const float cos_i = std::min(std::abs(dot(ray.direction, point.smooth_normal)), 1.0f);
      if (samples.next_1d() < fresnel(cos_i, glass->ior)) {
        ray.direction = normalize(reflect(-ray.direction, point.smooth_normal));
        ray.origin = leave_surface(point, ray.direction);
        path.pdf = 0.0f;
        t_near = 0.0f;
      } else {
        t_near = behind(hit, point);
      }
      continue;
    }
    if (path.bounce > options_.max_bounces) break;

    const Surface surface = make_surface(point, -ray.direction);
    const bool is_first = path.is_from_eye && first;
    path.footprint = footprint;
    float chance = specular_chance(surface);
    bool goes_on = true, is_specular = false;
    if (is_first) first->albedo = conversion_.to_rgb(surface.reflectance);
    if (path.is_from_eye && surface.transport) {
      const ExitPoint exit{surface.point, surface.boundary, surface.wo.z, -ray.direction};
      const Bands inside = throughput * surface.transport->leaving_radiance(
                                            exit, Gatherer(*this, path.bounce), samples);
      radiance += inside;
      if (is_first) {
        first->is_subsurface = true;
        first->subsurface = conversion_.to_rgb(inside);
      }
      if (surface.boundary.count == 0) break;
      chance = std::min(1.0f, 0.2f + 4.0f * reflectance(surface.boundary, surface.wo.z));
      const Bands mirrored =
          throughput * direct_light(surface, false, chance, 0.0f, samples).specular;
      radiance += mirrored;
      if (is_first) first->specular += conversion_.to_rgb(mirrored);
      const SpecularSample sample =
          sample_specular(surface.boundary, surface.wo, samples.next_1d(), samples.next_2d());
      goes_on = sample.weight > 0.0f && samples.next_1d() < chance;
      is_specular = true;
      if (goes_on) {
        throughput *= sample.weight / chance;
        path.pdf = sample.is_mirror ? 0.0f : sample.pdf * chance;
        path.spread = std::max(path.spread, sample.is_mirror ? 0.0f : 0.1f);
        ray.direction = surface.frame.to_world(sample.wi);
        goes_on = dot(ray.direction, surface.point.geometric_normal) > 0.0f;
        ray.origin = leave_surface(surface.point, ray.direction);
      }
    } else {
      const Reflected direct = direct_light(surface, true, chance, 1.0f - chance, samples);
      radiance += without_caustics(throughput * direct.specular, path) + throughput * direct.base;
      if (is_first) first->specular += conversion_.to_rgb(throughput * direct.specular);
      if (is_first && surface.layered) {
        first->is_subsurface = true;
        first->subsurface = conversion_.to_rgb(throughput * direct.base);
      }
      goes_on = scatter(surface, chance, ray, path, throughput, is_specular, samples);
    }
    if (!goes_on) break;
    if (is_first) {
      is_mirrored = is_specular;
      is_from_layers = !is_specular && surface.layered;
      before_turn = radiance;
    }
    path.is_camera_ray = path.is_from_eye = false;
    path.sees_lamps = true;
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
  if (is_mirrored) first->specular += conversion_.to_rgb(radiance - before_turn);
  if (is_from_layers) first->subsurface += conversion_.to_rgb(radiance - before_turn);
  return radiance;
}

template <int N>
CameraSample PathTracer<N>::trace_camera_ray(const Ray& ray, float spread,
                                             PixelSamples& samples) const {
  CameraSample sample;
  const Path path{.spread = spread, .is_camera_ray = true, .is_from_eye = true};
  sample.beauty = conversion_.to_rgb(follow(ray, path, samples, &sample));
  return sample;
}

template class PathTracer<4>;
template class PathTracer<8>;
template class PathTracer<16>;

}  // namespace lamina
