// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/rough/surface_boundary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/rough/interface_reflectance.h"

namespace lamina {
namespace {

constexpr float smooth_below = 1e-3f;  // such a lobe is narrower than any pixel

RoughInterface<float> interface_of(const SpecularLobe& lobe) {
  return {.facets = {.alpha = lobe.roughness, .distribution = lobe.table->distribution()},
          .eta = lobe.table->ior()};
}

bool is_smooth(const SpecularLobe& lobe) { return lobe.roughness < smooth_below; }

/// Density of the mirror direction of a facet seen from wo.
float pdf_lobe(const SpecularLobe& lobe, const Vec3f& wo, const Vec3f& wi) {
  const Vec3f h = normalize(wi + wo);
  const float wo_h = dot(wo, h);
  if (!(wo_h > 0.0f)) return 0.0f;
  return pdf_visible_normal(interface_of(lobe).facets, wo, h) / (4.0f * wo_h);
}

/// Share of the samples that a lobe gets.
float lobe_probability(const SurfaceBoundary& boundary, int i) {
  float total = 0.0f;
  for (int j = 0; j < boundary.count; ++j)
    total += boundary.lobes[static_cast<std::size_t>(j)].share;
  return boundary.lobes[static_cast<std::size_t>(i)].share / total;
}

}  // namespace

BoundaryReflectance::BoundaryReflectance(float ior, MicrofacetDistribution distribution,
                                         float roughness, bool is_mapped)
    : ior_(ior), distribution_(distribution) {
  if (!is_mapped)
    roughness_ = {roughness};
  else
    roughness_ = {0.0f, 0.05f, 0.1f, 0.15f, 0.2f, 0.3f, 0.4f, 0.5f, 0.7f, 1.0f};
  rows_.resize(roughness_.size());
  parallel_for(rows_.size(), [&](std::size_t i) {
    const float alpha = roughness_[i] < smooth_below ? 0.0f : roughness_[i];
    const RoughInterface<double> interface {
      .facets = {.alpha = static_cast<double>(alpha), .distribution = distribution},
      .eta = static_cast<double>(ior)
    };
    const InterfaceReflectance table =
        make_interface_reflectance(interface, FacetMasking::v_cavity);
    for (std::size_t a = 0; a < angles; ++a)
      rows_[i].reflectance[a] =
          static_cast<float>(lamina::reflectance(table, static_cast<double>(a) / (angles - 1)));
    // Of the piecewise linear table itself, so that what leaves adds up to exactly what there is.
    double diffuse = 0.0;
    const double h = 1.0 / (angles - 1);
    for (std::size_t a = 0; a + 1 < angles; ++a) {
      const double x0 = static_cast<double>(a) * h,
                   y0 = static_cast<double>(rows_[i].reflectance[a]);
      const double y1 = static_cast<double>(rows_[i].reflectance[a + 1]);
      diffuse += 2.0 * h * (x0 * 0.5 * (y0 + y1) + h * (y0 / 6.0 + y1 / 3.0));
    }
    rows_[i].diffuse = static_cast<float>(diffuse);
  });
}

BoundaryReflectance::Place BoundaryReflectance::find_row(float roughness) const {
  if (rows_.size() == 1 || !(roughness > roughness_.front())) return {0, 0.0f};
  std::size_t row = 0;
  while (row + 2 < rows_.size() && roughness_[row + 1] <= roughness) ++row;
  const float span = roughness_[row + 1] - roughness_[row];
  return {row, std::min((roughness - roughness_[row]) / span, 1.0f)};
}

float BoundaryReflectance::at(float roughness, float cos_i) const {
  const auto [row, blend] = find_row(roughness);
  const float x = std::clamp(cos_i, 0.0f, 1.0f) * static_cast<float>(angles - 1);
  const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(angles - 2));
  const float f = x - static_cast<float>(i);
  const auto in_row = [&](const Row& r) {
    return r.reflectance[i] + f * (r.reflectance[i + 1] - r.reflectance[i]);
  };
  const float value = in_row(rows_[row]);
  return blend > 0.0f ? value + blend * (in_row(rows_[row + 1]) - value) : value;
}

float BoundaryReflectance::diffuse(float roughness) const {
  const auto [row, blend] = find_row(roughness);
  const float value = rows_[row].diffuse;
  return blend > 0.0f ? value + blend * (rows_[row + 1].diffuse - value) : value;
}

float reflectance(const SurfaceBoundary& boundary, float cos_i) {
  float total = 0.0f;
  for (int i = 0; i < boundary.count; ++i) {
    const SpecularLobe& lobe = boundary.lobes[static_cast<std::size_t>(i)];
    total += lobe.share * lobe.table->at(lobe.roughness, cos_i);
  }
  return total;
}

float exit_distribution(const SurfaceBoundary& boundary, float cos_o) {
  float entering = 1.0f;
  for (int i = 0; i < boundary.count; ++i) {
    const SpecularLobe& lobe = boundary.lobes[static_cast<std::size_t>(i)];
    entering -= lobe.share * lobe.table->diffuse(lobe.roughness);
  }
  return (1.0f - reflectance(boundary, cos_o)) /
         (std::numbers::pi_v<float> * std::max(entering, 1e-4f));
}

float specular_brdf(const SurfaceBoundary& boundary, const Vec3f& wi, const Vec3f& wo) {
  if (!(wi.z > 0.0f && wo.z > 0.0f)) return 0.0f;
  float value = 0.0f;
  for (int i = 0; i < boundary.count; ++i) {
    const SpecularLobe& lobe = boundary.lobes[static_cast<std::size_t>(i)];
    if (!is_smooth(lobe)) value += lobe.share * torrance_sparrow_brdf(interface_of(lobe), wi, wo);
  }
  return value;
}

float pdf_specular(const SurfaceBoundary& boundary, const Vec3f& wo, const Vec3f& wi) {
  if (!(wi.z > 0.0f && wo.z > 0.0f)) return 0.0f;
  float pdf = 0.0f;
  for (int i = 0; i < boundary.count; ++i) {
    const SpecularLobe& lobe = boundary.lobes[static_cast<std::size_t>(i)];
    if (!is_smooth(lobe)) pdf += lobe_probability(boundary, i) * pdf_lobe(lobe, wo, wi);
  }
  return pdf;
}

SpecularSample sample_specular(const SurfaceBoundary& boundary, const Vec3f& wo, float u_lobe,
                               Vec2f u) {
  if (boundary.count == 0 || !(wo.z > 0.0f)) return {};
  int chosen = 0;
  for (float below = lobe_probability(boundary, 0); chosen + 1 < boundary.count && u_lobe >= below;
       below += lobe_probability(boundary, chosen))
    ++chosen;
  const SpecularLobe& lobe = boundary.lobes[static_cast<std::size_t>(chosen)];
  if (is_smooth(lobe)) {
    const float reflected = lobe.share * lobe.table->at(lobe.roughness, wo.z);
    return {.wi = {-wo.x, -wo.y, wo.z},
            .weight = reflected / lobe_probability(boundary, chosen),
            .is_mirror = true};
  }
  const Vec3f h = sample_visible_normal(interface_of(lobe).facets, wo, u.x, u.y);
  const Vec3f wi = reflect(wo, h);
  const float pdf = pdf_specular(boundary, wo, wi);
  if (!(pdf > 0.0f)) return {};
  return {.wi = wi, .weight = specular_brdf(boundary, wi, wo) * wi.z / pdf, .pdf = pdf};
}

}  // namespace lamina
