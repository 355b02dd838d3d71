// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/dielectric_scattering.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/vec.h"
#include "lamina/layers/optics/rough/gaussian_surface.h"
#include "lamina/layers/optics/rough/multiple_scattering.h"

namespace lamina {
namespace {

GaussianSurface gaussian_surface(const RoughInterface<double>& interface) {
  return {.smoothness = 2.0 / interface.facets.alpha, .eta = interface.eta};
}

/// About the share of diffuse light that meets more than one facet; any value serves.
double several_facets(double alpha) {
  const double a2 = alpha * alpha;
  return 0.01 + 0.3 * a2 / (1.0 + 0.3 * a2);
}

}  // namespace

DielectricScattering dielectric_at(const TextureStore& textures, const DielectricSurface& surface,
                                   const SurfacePoint& point, bool is_inside) {
  const float alpha =
      surface.smoothness
          ? 2.0f / std::clamp(textures.scalar(*surface.smoothness, point), 0.1f, 1e4f)
          : std::clamp(textures.scalar(surface.roughness, point), 0.0f, 1.0f);
  const auto ior = static_cast<double>(surface.ior);
  return {.interface = {.facets = {static_cast<double>(alpha), surface.distribution},
                        .eta = is_inside ? 1.0 / ior : ior},
          .scattering = surface.scattering};
}

float evaluate_dielectric(const DielectricScattering& boundary, const Vec3f& wo, const Vec3f& wi,
                          PixelSamples& samples) {
  const Vec3 from = to_double(wo), to = to_double(wi);
  double value = 0.0;
  if (is_specular(boundary.interface) || to.z == 0.0) return 0.0f;
  switch (boundary.scattering) {
    case FacetScattering::single:
      value = bsdf(boundary.interface, from, to);
      break;
    case FacetScattering::multiple: {
      Random random = make_stream(samples);
      value = evaluate_multiple_scattering(boundary.interface, from, to, random);
      break;
    }
    case FacetScattering::xu_sun:
      value = single_scattering_bsdf(gaussian_surface(boundary.interface), from, to);
      break;
  }
  return static_cast<float>(value * std::abs(to.z));
}

float pdf_dielectric(const DielectricScattering& boundary, const Vec3f& wo, const Vec3f& wi) {
  const Vec3 from = to_double(wo), to = to_double(wi);
  if (is_specular(boundary.interface)) return 0.0f;
  return static_cast<float>(
      boundary.scattering == FacetScattering::multiple
          ? approximate_pdf_multiple_scattering(
                boundary.interface, from, to, 1.0 - several_facets(boundary.interface.facets.alpha))
          : pdf_rough_interface(boundary.interface, from, to));
}

DielectricSample sample_dielectric(const DielectricScattering& boundary, const Vec3f& wo,
                                   PixelSamples& samples) {
  const Vec3 from = to_double(wo);
  const auto u3 = static_cast<double>(samples.next_1d());
  const Vec2f u = samples.next_2d();
  const auto u1 = static_cast<double>(u.x), u2 = static_cast<double>(u.y);
  if (boundary.scattering == FacetScattering::multiple && !is_specular(boundary.interface)) {
    Random random = make_stream(samples);
    const auto [to, order] = sample_multiple_scattering(boundary.interface, from, random);
    if (order == 0 || to.z == 0.0) return {};
    const Vec3f wi = to_float(to);
    return {.wi = wi, .weight = 1.0f, .pdf = pdf_dielectric(boundary, wo, wi)};
  }
  const auto sample =
      boundary.scattering == FacetScattering::xu_sun
          ? sample_single_scattering(gaussian_surface(boundary.interface), from, u1, u2, u3)
          : sample_rough_interface(boundary.interface, from, u1, u2, u3);
  return {.wi = to_float(sample.wo),
          .weight = static_cast<float>(sample.weight),
          .pdf = static_cast<float>(sample.pdf)};
}

}  // namespace lamina
