// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lamina/base/core/low_discrepancy.h"
#include "lamina/render/lights/light_cluster_sampler.h"
#include "lamina/render/paths/path.h"
#include "lamina/render/shading/shadow_transmittance.h"

namespace lamina {

/// MIS weight of a light that a surface's own sampling met, with these densities of the two ways to
/// find it [1/sr]; of the surface 0: in one direction only, of the light 0: not by next-event
/// estimation.
/// @param candidates  that next-event estimation had there, as mis_weight_of_light_sample
///
/// Source: multiple importance sampling, the power heuristic of [VeachGuibas1995].
[[nodiscard]] inline float mis_weight_of_surface_sample(RenderOptions::DirectLight way, float pdf,
                                                        float pdf_light, float candidates) {
  if (pdf == 0.0f || pdf_light == 0.0f) return 1.0f;  // next-event estimation cannot find it
  if (way == RenderOptions::DirectLight::surfaces_only) return 1.0f;
  if (way == RenderOptions::DirectLight::lights_only) return 0.0f;
  pdf_light *= candidates;
  return pdf * pdf / (pdf * pdf + pdf_light * pdf_light);  // the power heuristic
}

/// MIS weight of a light sample whose direction the surface samples with density pdf [1/sr].
[[nodiscard]] inline float mis_weight_of_light_sample(RenderOptions::DirectLight way,
                                                      const LightSample& light, float pdf,
                                                      float candidates = light_candidates) {
  if (light.is_delta || way == RenderOptions::DirectLight::lights_only) return 1.0f;
  if (way == RenderOptions::DirectLight::surfaces_only) return 0.0f;
  const float pdf_light = candidates * light.pdf;
  return pdf_light * pdf_light / (pdf * pdf + pdf_light * pdf_light);
}

template <int N>
struct ResampledLight {
  LightSample light;
  float weight = 0.0f;          ///< on its radiance; 0: nothing to be had
  float open_weight = 0.0f;     ///< the same if nothing were in its way
  BandValues<N> transmittance;  ///< shadow transmittance: fraction that arrives
};

/// Next-event estimation by resampled importance sampling: a light, chosen among candidates in
/// proportion to what each would give without shadows; one shadow ray is traced.
///
/// @param value  value(LightSample) is the factor on its radiance, the target of the resampling
/// @param stratum   of the lights, to sample the candidates from
/// @param clusters  to sample the candidates from instead, if not null
///
/// Source: [Talbot2005].
template <int N, class Value>
[[nodiscard]] ResampledLight<N> resample_light(const PathWorld<N>& world, const SurfacePoint& point,
                                               PixelSamples& samples, const Value& value,
                                               Dielectrics dielectrics = Dielectrics::transmit,
                                               const LightStratum& stratum = {},
                                               const LightClusterSampler* clusters = nullptr) {
  const float u_light = samples.next_1d();
  const Vec2f u = samples.next_2d();
  const auto fraction = [](float x) { return x - std::floor(x); };
  ResampledLight<N> chosen;
  float total = 0.0f, chosen_brightness = 0.0f, chosen_pdf = 0.0f, u_left = samples.next_1d();
  for (int i = 0; i < stratum.candidates; ++i) {
    // A lattice of candidates, moved as one: [Roberts2018]'s R2 sequence.
    const auto k = static_cast<float>(i);
    const float u_which = fraction(u_light + k / static_cast<float>(stratum.candidates));
    const Vec2f u_where{fraction(u.x + 0.7548777f * k), fraction(u.y + 0.5698403f * k)};
    const auto [light, density_ratio] =
        clusters ? clusters->sample(u_which, u_where)
                 : LightClusterSampler::Sample{
                       world.scene.lights.sample_light(
                           point.position, stratum.low + stratum.size * u_which, u_where),
                       1.0f / stratum.size};
    if (!(light.pdf > 0.0f)) continue;
    const float pdf = density_ratio * light.pdf;
    const float brightness =
        (light.radiance.x + light.radiance.y + light.radiance.z) * value(light) / pdf;
    if (!(brightness > 0.0f)) continue;
    total += brightness;
    const float chance = brightness / total;
    if (u_left < chance) {
      u_left /= chance;
      chosen.light = light;
      chosen_brightness = brightness;
      chosen_pdf = pdf;
    } else {
      u_left = (u_left - chance) / std::max(1.0f - chance, 1e-9f);
    }
  }
  if (!(total > 0.0f)) return chosen;
  const LightSample& light = chosen.light;
  const Ray ray{leave_surface(point, light.direction), light.direction};
  chosen.transmittance =
      shadow_transmittance(world.scene, world.sheets, ray, 0.9999f * light.distance, dielectrics);
  chosen.open_weight =
      total / (chosen_brightness * chosen_pdf * static_cast<float>(stratum.candidates));
  if (largest(chosen.transmittance) > 0.0f) chosen.weight = chosen.open_weight;
  return chosen;
}

}  // namespace lamina
