// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/internal/path_step.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/render/paths/internal/direct_light.h"

namespace lamina {
namespace {

/// What a surface makes of light from one direction.
struct Lobes {
  float specular = 0.0f, base = 0.0f;  ///< BRDFs [1/sr], base for a reflectance of 1
  float scale = 0.0f;                  ///< cosine, and share among the ways to draw the direction
};

}  // namespace

template <int N>
Reflected<N> direct_light(const PathWorld<N>& world, const PathSurface<N>& surface, bool with_base,
                          float specular_chance, float base_chance, PixelSamples& samples) {
  // Where there is a mirror alone, lights are chosen by what it makes of them.
  std::optional<LightClusterSampler> parts;
  if (!with_base && world.scene.lights.cluster_count() > 0)
    parts.emplace(
        world.scene.lights,
        BoundaryView{surface.boundary, surface.frame.z, surface.frame.to_world(surface.wo)},
        surface.point.position);
  const float candidates = with_base ? light_candidates : specular_light_candidates(world);
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
    lobes.scale = std::abs(wi.z) *
                  mis_weight_of_light_sample(world.options.direct_light, light, pdf, candidates);
    return lobes;
  };
  const float brightness = with_base ? sum(surface.reflectance) / N : 0.0f;
  const float brightness_beyond = with_base ? sum(surface.transmittance) / N : 0.0f;
  const auto value = [&](const LightSample& light) {
    const Lobes lobes = reflected(light);
    const bool is_beyond = dot(light.direction, surface.frame.z) < 0.0f;
    return lobes.scale *
           (lobes.specular + (is_beyond ? brightness_beyond : brightness) * lobes.base);
  };
  const ResampledLight<N> drawn = resample_light(
      world, surface.point, samples, value, Dielectrics::transmit, {}, parts ? &*parts : nullptr);
  if (!(drawn.weight > 0.0f)) return {};
  Lobes lobes = reflected(drawn.light);
  const Vec3f wi = surface.frame.to_local(drawn.light.direction);
  if (surface.layered && with_base) {
    const auto layers = surface.layered->evaluate(wi, samples);
    float pdf = base_chance * (1.0f - surface.mirrored_chance) * layers.pdf;
    if (lobes.specular > 0.0f)
      pdf += specular_chance * pdf_specular(surface.boundary, surface.wo, wi);
    const float scale =
        wi.z * mis_weight_of_light_sample(world.options.direct_light, drawn.light, pdf);
    const BandValues<N> arriving =
        drawn.weight * scale * drawn.clear * world.conversion.from_rgb(drawn.light.radiance);
    return {.specular = lobes.specular * arriving, .base = layers.bsdf * arriving};
  }
  const BandValues<N> arriving =
      drawn.weight * lobes.scale * drawn.clear * world.conversion.from_rgb(drawn.light.radiance);
  return {.specular = lobes.specular * arriving,
          .base = lobes.base * base_color(surface, wi) * arriving};
}

template <int N>
bool scatter(const PathSurface<N>& surface, float chance, Ray& ray, Path& path,
             BandValues<N>& throughput, bool& is_specular, PixelSamples& samples) {
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
    wi = sample_cosine_hemisphere(u2);
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
    const BandValues<N> mirrored =
        BandValues<N>::filled(specular_brdf(surface.boundary, wi, surface.wo));
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
                   BandValues<N>::filled(specular_brdf(surface.boundary, wi, surface.wo)));
  }
  ray.origin = leave_surface(surface.point, ray.direction);
  return true;
}

template Reflected<4> direct_light(const PathWorld<4>&, const PathSurface<4>&, bool, float, float,
                                   PixelSamples&);
template bool scatter(const PathSurface<4>&, float, Ray&, Path&, BandValues<4>&, bool&,
                      PixelSamples&);
template Reflected<8> direct_light(const PathWorld<8>&, const PathSurface<8>&, bool, float, float,
                                   PixelSamples&);
template bool scatter(const PathSurface<8>&, float, Ray&, Path&, BandValues<8>&, bool&,
                      PixelSamples&);
template Reflected<16> direct_light(const PathWorld<16>&, const PathSurface<16>&, bool, float,
                                    float, PixelSamples&);
template bool scatter(const PathSurface<16>&, float, Ray&, Path&, BandValues<16>&, bool&,
                      PixelSamples&);

}  // namespace lamina
