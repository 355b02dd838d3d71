// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/internal/path_step.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lamina/render/paths/internal/direct_light.h"

namespace lamina {
namespace {

/// How many candidates a light sample that product importance sampling gave counts as.
template <int N>
float specular_light_candidates(const PathWorld<N>& world) {
  return world.scene.lights.cluster_count() > 0 ? product_sampling_candidates : light_candidates;
}

float pdf_of_boundary(const BoundaryPoint& at, float chance, const Vec3f& wi) {
  return chance > 0.0f ? chance * pdf_specular(at.boundary, at.wo, wi) : 0.0f;
}

/// Direct light that a boundary mirrors, by product importance sampling of lights and lobe.
template <int N>
BandValues<N> specular_direct_light(const PathWorld<N>& world, const BoundaryPoint& at,
                                    PixelSamples& samples) {
  std::optional<LightClusterSampler> clusters;
  if (world.scene.lights.cluster_count() > 0)
    clusters.emplace(world.scene.lights,
                     BoundaryView{at.boundary, at.frame.z, at.frame.to_world(at.wo)},
                     at.point.position);
  const float candidates = specular_light_candidates(world);
  struct Lobe {
    float brdf = 0.0f, scale = 0.0f;  ///< scale: cosine and MIS weight
  };
  const auto lobe = [&](const LightSample& light) -> Lobe {
    const Vec3f wi = at.frame.to_local(light.direction);
    if (!leaves_by_its_side(at.point, light.direction, wi)) return {};
    const float brdf = specular_brdf(at.boundary, wi, at.wo);
    if (!(brdf > 0.0f)) return {};
    const float pdf = light.is_delta ? 0.0f : pdf_specular(at.boundary, at.wo, wi);
    return {brdf, std::abs(wi.z) * mis_weight_of_light_sample(world.options.direct_light, light,
                                                              pdf, candidates)};
  };
  const auto target = [&](const LightSample& light) {
    const auto [brdf, scale] = lobe(light);
    return scale * brdf;
  };
  const ResampledLight<N> chosen = resample_light(
      world, at.point, samples, target, Dielectrics::transmit, {}, clusters ? &*clusters : nullptr);
  if (!(chosen.weight > 0.0f)) return {};
  const auto [brdf, scale] = lobe(chosen.light);
  return brdf * (chosen.weight * scale * chosen.transmittance *
                 world.conversion.from_rgb(chosen.light.radiance));
}

/// A translucent object: its inside is gathered, and the path is continued by the boundary alone.
template <int N>
PathStep<N> make_step(const PathWorld<N>& world, const BoundaryPoint& at,
                      const TranslucentBase<N>& base, const PathState<N>& path,
                      const LightGatherer<N>& gatherer, PixelSamples& samples) {
  PathStep<N> step{.is_subsurface = true, .is_specular = true};
  const ExitPoint exit{at.point, at.boundary, at.wo.z, -path.ray.direction};
  step.inside = base.method->leaving_radiance(exit, gatherer, samples);
  if (at.boundary.count == 0) return step;
  step.specular = specular_direct_light(world, at, samples);
  const Vec2f u = samples.next_2d();
  const SpecularSample sample = sample_specular(at.boundary, at.wo, samples.next_1d(), u);
  if (!(sample.weight > 0.0f)) return step;
  step.weight = BandValues<N>::filled(sample.weight);
  step.pdf = sample.is_mirror ? 0.0f : sample.pdf;
  step.candidates = specular_light_candidates(world);
  step.spread = std::max(path.spread, sample.is_mirror ? 0.0f : 0.1f);
  step.direction = at.frame.to_world(sample.wi);
  step.continues = dot(step.direction, at.point.geometric_normal) > 0.0f;
  return step;
}

/// Adds the direct light of a surface that scatters where light enters, by one light sample.
template <int N, class Base>
void add_direct_light(const PathWorld<N>& world, const BoundaryPoint& at, const Base& base,
                      float specular_chance, PathStep<N>& step, PixelSamples& samples) {
  const float base_chance = 1.0f - specular_chance;
  const auto scale = [&](const LightSample& light, const Vec3f& wi, float specular,
                         float base_pdf) {
    float pdf = base_pdf;
    if (specular > 0.0f && !light.is_delta)
      pdf += specular_chance * pdf_specular(at.boundary, at.wo, wi);
    return std::abs(wi.z) * mis_weight_of_light_sample(world.options.direct_light, light, pdf);
  };
  const auto target = [&](const LightSample& light) {
    const Vec3f wi = at.frame.to_local(light.direction);
    if (!leaves_by_its_side(at.point, light.direction, wi)) return 0.0f;
    const float specular = specular_brdf(at.boundary, wi, at.wo), gray = base.estimate(at, wi);
    if (!(specular + gray > 0.0f)) return 0.0f;
    return scale(light, wi, specular, base_chance * base.pdf(wi)) * (specular + gray);
  };
  const ResampledLight<N> chosen = resample_light(world, at.point, samples, target);
  if (!(chosen.weight > 0.0f)) return;
  const Vec3f wi = at.frame.to_local(chosen.light.direction);
  const float specular = specular_brdf(at.boundary, wi, at.wo);
  const BaseValue<N> value = base.evaluate(at, wi, samples);
  const float base_pdf = base_chance * base.continuous_chance() * value.pdf;
  const BandValues<N> arriving = chosen.weight * scale(chosen.light, wi, specular, base_pdf) *
                                 chosen.transmittance *
                                 world.conversion.from_rgb(chosen.light.radiance);
  step.specular = specular * arriving;
  step.base = value.bsdf * arriving;
}

/// Continues a path by the boundary, with the given chance, or the base. Both may give the
/// direction that one of them samples, so both count.
template <int N, class Base>
void sample_direction(const BoundaryPoint& at, const Base& base, float specular_chance,
                      float spread, PathStep<N>& step, PixelSamples& samples) {
  const float u = samples.next_1d();
  const Vec2f u2 = samples.next_2d();
  const float base_chance = 1.0f - specular_chance;
  step.is_specular = u < specular_chance;
  Vec3f wi;
  bool is_delta = false;
  std::optional<BaseValue<N>> value;
  if (step.is_specular) {
    const SpecularSample sample = sample_specular(at.boundary, at.wo, u / specular_chance, u2);
    if (!(sample.weight > 0.0f)) return;
    wi = sample.wi;
    is_delta = sample.is_mirror;
    if (is_delta) step.weight = BandValues<N>::filled(sample.weight / specular_chance);
    step.spread = std::max(spread, is_delta ? 0.0f : 0.1f);
  } else {
    const auto sample = base.sample(at, u - specular_chance, base_chance, u2, samples);
    if (!sample) return;
    wi = sample->wi;
    value = sample->value;
    is_delta = sample->delta_weight.has_value();
    if (is_delta) step.weight = *sample->delta_weight;
    step.spread = is_delta ? spread : 0.3f;
  }
  step.direction = at.frame.to_world(wi);
  if (!leaves_by_its_side(at.point, step.direction, wi)) return;
  step.continues = true;
  if (is_delta) return;
  if (!value) value = base.evaluate(at, wi, samples);
  const float of_base = base_chance * base.continuous_chance() * value->pdf;
  const float of_boundary = pdf_of_boundary(at, specular_chance, wi);
  step.pdf = of_base + of_boundary;
  step.continues = step.pdf > 0.0f;
  const auto mirrored = BandValues<N>::filled(specular_brdf(at.boundary, wi, at.wo));
  const float cos_i = std::abs(wi.z);
  if (!base.is_random())
    step.weight = (cos_i / step.pdf) * (value->bsdf + mirrored);
  else if (step.is_specular)
    step.weight = (cos_i / of_boundary) * mirrored;
  else
    step.weight = (cos_i / of_base) * value->bsdf;
}

/// A surface that scatters light where it enters.
template <int N, class Base>
PathStep<N> make_step(const PathWorld<N>& world, const BoundaryPoint& at, const Base& base,
                      const PathState<N>& path, const LightGatherer<N>&, PixelSamples& samples) {
  PathStep<N> step{.is_subsurface = base.is_subsurface, .candidates = light_candidates};
  const float specular_chance = at.specular_chance(largest(base.scattered()));
  add_direct_light(world, at, base, specular_chance, step, samples);
  sample_direction(at, base, specular_chance, path.spread, step, samples);
  return step;
}

/// A covered surface: as one that scatters light where it enters, with what comes from inside.
template <int N>
PathStep<N> make_step(const PathWorld<N>& world, const BoundaryPoint& at,
                      const CoveredBase<N>& base, const PathState<N>& path,
                      const LightGatherer<N>& gatherer, PixelSamples& samples) {
  PathStep<N> step = make_step<N, CoveredBase<N>>(world, at, base, path, gatherer, samples);
  if (!base.method) return step;
  const ExitPoint exit{at.point, at.boundary, at.wo.z, -path.ray.direction};
  step.inside = base.leaving * base.method->leaving_radiance(exit, gatherer, samples);
  return step;
}

}  // namespace

template <int N>
PathStep<N> make_path_step(const PathWorld<N>& world, const PathSurface<N>& surface,
                           const PathState<N>& path, const LightGatherer<N>& gatherer,
                           PixelSamples& samples) {
  return std::visit(
      [&](const auto& base) { return make_step(world, surface.at, base, path, gatherer, samples); },
      surface.base);
}

#define LAMINA_INSTANTIATE(N)                                                     \
  template PathStep<N> make_path_step(const PathWorld<N>&, const PathSurface<N>&, \
                                      const PathState<N>&, const LightGatherer<N>&, PixelSamples&)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
