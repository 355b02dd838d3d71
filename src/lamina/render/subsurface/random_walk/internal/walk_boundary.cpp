// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/random_walk/internal/walk_boundary.h"

#include "lamina/render/shading/refracted_entry.h"

namespace lamina {
namespace {

constexpr float least_cosine = 1e-4f;
constexpr int most_tries = 100;

}  // namespace

DielectricScattering facet_scattering(float eta, const Interface& facets) {
  return {.interface = {.facets = {facets.roughness, facets.distribution},
                        .eta = static_cast<double>(eta)},
          .scattering = FacetScattering::multiple};
}

WalkBoundary make_walk_boundary(const SurfacePoint& point, const Vec3f& direction,
                                const DielectricScattering& scattering) {
  const float side = dot(point.geometric_normal, direction) > 0.0f ? -1.0f : 1.0f;
  const Vec3f inner_facet = side * point.geometric_normal;
  Vec3f n = side * point.smooth_normal;
  if (!(dot(n, direction) < -least_cosine)) n = inner_facet;  // not seen from here
  const Framef frame = make_frame(n);
  return {scattering, frame, inner_facet, frame.to_local(-direction)};
}

BoundaryTurn sample_turn(const WalkBoundary& boundary, PixelSamples& samples) {
  if (boundary.back.z > 0.0f) {
    const DielectricSample sample = sample_dielectric(boundary.scattering, boundary.back, samples);
    const Vec3f direction = normalize(boundary.frame.to_world(sample.wi));
    const bool passes = sample.wi.z < 0.0f;
    if (sample.weight > 0.0f && passes == (dot(direction, boundary.inner_facet) < 0.0f))
      return {direction, passes, sample.pdf, sample.weight};
    // Models of a single facet lose the light that meets another.
    if (!(sample.weight > 0.0f) && !is_specular(boundary.scattering.interface) &&
        boundary.scattering.scattering != FacetScattering::multiple)
      return {.weight = 0.0f};
  }
  // What the smooth normal sends through the facet, or would not, is reflected by the facet.
  const Vec3f back = boundary.frame.to_world(boundary.back);
  return {.direction =
              normalize(2.0f * dot(back, boundary.inner_facet) * boundary.inner_facet - back)};
}

BoundaryLight light_through(const WalkBoundary& boundary, const Vec3f& to_light,
                            PixelSamples& samples) {
  const Vec3f wi = boundary.frame.to_local(to_light);
  if (!(boundary.back.z > 0.0f && wi.z < 0.0f && dot(to_light, boundary.inner_facet) < 0.0f))
    return {};
  return {evaluate_dielectric(boundary.scattering, boundary.back, wi, samples),
          pdf_dielectric(boundary.scattering, boundary.back, wi)};
}

Vec3f sample_entry(const Vec3f& to_eye, const Vec3f& normal, float ior, const Interface& facets,
                   PixelSamples& samples) {
  const DielectricScattering scattering = facet_scattering(ior, facets);
  if (is_specular(scattering.interface)) return -refract_inside(to_eye, normal, ior);
  const Framef frame = make_frame(normal);
  const Vec3f wo = frame.to_local(to_eye);
  // Reflection is sampled elsewhere: until one enters.
  for (int i = 0; i < most_tries && wo.z > 0.0f; ++i) {
    const DielectricSample sample = sample_dielectric(scattering, wo, samples);
    if (sample.weight > 0.0f && sample.wi.z < 0.0f) return normalize(frame.to_world(sample.wi));
  }
  return {};
}

}  // namespace lamina
