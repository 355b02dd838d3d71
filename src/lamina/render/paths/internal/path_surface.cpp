// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/paths/internal/path_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/float_pi.h"
#include "lamina/render/geometry/hemisphere.h"

namespace lamina {
namespace {

template <int N>
float brightness(const BandValues<N>& values) {
  return sum(values) / N;
}

/// The BRDF of a white diffuse base under a boundary.
float diffuse_lobe(const BoundaryPoint& at, const SurfaceBoundary& entered, float cos_i) {
  return (1.0f - reflectance(entered, cos_i)) * exit_distribution(at.boundary, at.wo.z);
}

// Surfaces that scatter light to both sides.

/// Share of the sampled light that comes from beyond.
template <class Base>
float beyond_chance(const Base& base) {
  const float t = sum(base.transmittance);
  return t > 0.0f ? std::clamp(t / (t + sum(base.reflectance)), 0.05f, 0.95f) : 0.0f;
}

template <int N>
std::optional<BaseSample<N>> sample_side(bool is_beyond, Vec2f u2) {
  Vec3f wi = sample_cosine_hemisphere(u2);
  if (is_beyond) wi.z = -wi.z;
  return BaseSample<N>{.wi = wi, .value = {}, .delta_weight = {}};
}

float pdf_both_sides(float beyond_chance, const Vec3f& wi) {
  return (wi.z > 0.0f ? 1.0f - beyond_chance : beyond_chance) * std::abs(wi.z) / float_pi;
}

}  // namespace

Vec3f make_visible(const Vec3f& n, const Vec3f& wo) {
  constexpr float least = 0.02f;
  const float cos_o = dot(n, wo);
  return cos_o >= least ? n : normalize(n + (least - cos_o) * wo);
}

bool leaves_by_its_side(const SurfacePoint& point, const Vec3f& direction, const Vec3f& local) {
  return local.z * dot(direction, point.geometric_normal) > 0.0f;
}

float BoundaryPoint::specular_chance(float base_reflectance) const {
  if (boundary.count == 0) return 0.0f;
  const float mirrored = reflectance(boundary, wo.z);
  const float base = (1.0f - mirrored) * base_reflectance;
  return std::clamp(mirrored / (mirrored + base + 1e-6f), 0.1f, 0.9f);
}

// Diffuse

template <int N>
BaseValue<N> DiffuseBase<N>::evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples&) const {
  return {wi.z < 0.0f ? diffuse_lobe(at, beyond, -wi.z) * transmittance
                      : diffuse_lobe(at, at.boundary, wi.z) * reflectance,
          pdf(wi)};
}

template <int N>
std::optional<BaseSample<N>> DiffuseBase<N>::sample(const BoundaryPoint&, float u, float chance,
                                                    Vec2f u2, PixelSamples&) const {
  return sample_side<N>(u < chance * beyond_chance(*this), u2);
}

template <int N>
float DiffuseBase<N>::pdf(const Vec3f& wi) const {
  return pdf_both_sides(beyond_chance(*this), wi);
}

template <int N>
float DiffuseBase<N>::estimate(const BoundaryPoint& at, const Vec3f& wi) const {
  const float scattered = brightness(wi.z < 0.0f ? transmittance : reflectance);
  if (!(scattered > 0.0f)) return 0.0f;
  return scattered * diffuse_lobe(at, wi.z < 0.0f ? beyond : at.boundary, std::abs(wi.z));
}

// Layers

template <int N>
BaseValue<N> LayeredBase<N>::evaluate(const BoundaryPoint&, const Vec3f& wi,
                                      PixelSamples& samples) const {
  const auto value = layers->evaluate(wi, samples);
  return {value.bsdf, value.pdf};
}

template <int N>
std::optional<BaseSample<N>> LayeredBase<N>::sample(const BoundaryPoint& at, float u, float chance,
                                                    Vec2f u2, PixelSamples& samples) const {
  float v = u / chance;
  if (v < mirrored_chance)
    return BaseSample<N>{.wi = {-at.wo.x, -at.wo.y, at.wo.z},
                         .value = {},
                         .delta_weight = (1.0f / (mirrored_chance * chance)) * mirrored};
  v = (v - mirrored_chance) / (1.0f - mirrored_chance);
  const auto drawn = layers->sample(std::min(v, 0x1.fffffep-1f), u2, samples);
  if (!(drawn.value.pdf > 0.0f)) return std::nullopt;
  return BaseSample<N>{
      .wi = drawn.wi, .value = BaseValue<N>{drawn.value.bsdf, drawn.value.pdf}, .delta_weight = {}};
}

template <int N>
float LayeredBase<N>::pdf(const Vec3f& wi) const {
  return std::max(wi.z, 0.0f) / float_pi;
}

template <int N>
float LayeredBase<N>::estimate(const BoundaryPoint&, const Vec3f& wi) const {
  return wi.z < 0.0f ? 0.0f : brightness(reflectance) * (1.0f / float_pi);
}

// Thin sheets

template <int N>
float SheetBase<N>::lobe(const BoundaryPoint& at, const Vec3f& wi) const {
  return diffuse_lobe(at, wi.z > 0.0f ? at.boundary : beyond, std::abs(wi.z));
}

template <int N>
BaseValue<N> SheetBase<N>::evaluate(const BoundaryPoint& at, const Vec3f& wi, PixelSamples&) const {
  const float cos_o = at.wo.z;
  const BandValues<N> scattered = wi.z > 0.0f ? sheet->reflection(place, side, wi.z, cos_o)
                                              : sheet->transmission(place, 1 - side, -wi.z, cos_o);
  return {lobe(at, wi) * (color * scattered), pdf(wi)};
}

template <int N>
std::optional<BaseSample<N>> SheetBase<N>::sample(const BoundaryPoint&, float u, float chance,
                                                  Vec2f u2, PixelSamples&) const {
  return sample_side<N>(u < chance * beyond_chance(*this), u2);
}

template <int N>
float SheetBase<N>::pdf(const Vec3f& wi) const {
  return pdf_both_sides(beyond_chance(*this), wi);
}

template <int N>
float SheetBase<N>::estimate(const BoundaryPoint& at, const Vec3f& wi) const {
  return brightness(wi.z < 0.0f ? transmittance : reflectance) * lobe(at, wi);
}

// Covered surfaces

template <int N>
BandValues<N> CoveredBase<N>::scattered_to(float cos_i, float cos_o) const {
  return cover.reflection(cos_i, cos_o) + cover.matte_reflection(cos_i, cos_o, matte) +
         cover.through(cos_i) * returned * cover.through(cos_o);
}

template <int N>
BaseValue<N> CoveredBase<N>::evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples&) const {
  if (!(wi.z > 0.0f)) return {{}, pdf(wi)};
  return {diffuse_lobe(at, at.boundary, wi.z) * scattered_to(wi.z, at.wo.z), pdf(wi)};
}

template <int N>
std::optional<BaseSample<N>> CoveredBase<N>::sample(const BoundaryPoint&, float, float, Vec2f u2,
                                                    PixelSamples&) const {
  return sample_side<N>(false, u2);
}

template <int N>
float CoveredBase<N>::pdf(const Vec3f& wi) const {
  return std::max(wi.z, 0.0f) / float_pi;
}

template <int N>
float CoveredBase<N>::estimate(const BoundaryPoint& at, const Vec3f& wi) const {
  if (!(wi.z > 0.0f)) return 0.0f;
  return brightness(scattered_to(wi.z, at.wo.z)) * diffuse_lobe(at, at.boundary, wi.z);
}

namespace {

/// What coverings and base reflect together, of the flux that has entered.
template <int N>
BandValues<N> covered_reflectance(const CoverAt<N>& cover, const BandValues<N>& base, float cos_o) {
  return cover.reflected(cos_o) +
         cover.through(cos_o) * base * cover.returning(base) * cover.mean_through();
}

template <int N>
CoveredBase<N> covered_matte(const CoverAt<N>& cover, const BandValues<N>& base, float cos_o) {
  return {.reflectance = covered_reflectance(cover, base, cos_o), .cover = cover, .matte = base};
}

/// @param method  that gathers its light; null: light leaves where it enters
template <int N>
CoveredBase<N> covered_translucent(const CoverAt<N>& cover, const BandValues<N>& base,
                                   const SubsurfaceMethod<N>* method, float cos_o) {
  CoveredBase<N> covered{.reflectance = covered_reflectance(cover, base, cos_o), .cover = cover};
  const BandValues<N> returning = cover.returning(base);
  if (!method) {
    covered.returned = base * returning;
    return covered;
  }
  covered.method = method;
  covered.leaving = sqrt(returning) * cover.through(cos_o);
  covered.is_subsurface = true;
  return covered;
}

}  // namespace

template <int N>
PathSurface<N> make_path_surface(const PathWorld<N>& world, const SurfacePoint& point,
                                 const Vec3f& towards_eye, bool is_from_eye) {
  const ThinSheet<N>* sheet = world.sheets[point.material].get();
  const SubsurfaceMethod<N>* method = world.transports[point.material].get();
  const bool is_inside = dot(point.geometric_normal, towards_eye) < 0.0f;
  const bool is_sheet = sheet || (method && method->is_sheet(point));
  PathSurface<N> surface{.at = {.point = is_inside ? turned_over(point, is_sheet) : point},
                         .base = DiffuseBase<N>{}};
  SurfacePoint& p = surface.at.point;
  surface.at.boundary = boundary_at(world.scene, p);
  p.normal = make_visible(p.normal, towards_eye);
  surface.at.frame = make_frame(p.normal);
  surface.at.wo = surface.at.frame.to_local(towards_eye);
  const auto boundary_beyond = [&] { return boundary_at(world.scene, turned_over(p, true)); };
  const auto& material = world.scene.scene->materials[p.material];
  const auto color_of = [&](const ColorParameter& parameter) {
    const Vec3f c = world.scene.textures.color(parameter, p);
    return world.conversion.from_rgb(
        {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)});
  };
  const auto cover = cover_at(world.scene, world.coverings, p);
  if (const auto* diffuse = std::get_if<DiffuseSurface>(&material.surface)) {
    const BandValues<N> reflectance = color_of(diffuse->color);
    if (cover)
      surface.base = covered_matte<N>(*cover, reflectance, surface.at.wo.z);
    else
      surface.base = DiffuseBase<N>{reflectance};
  } else if (sheet) {
    const auto place = sheet->place_at(world.scene.textures, p);
    const int side = is_inside ? 1 : 0;
    const BandValues<N> color = color_of(std::get<ThinSurface>(material.surface).color);
    const auto fractions = sheet->fractions(place, side, surface.at.wo.z);
    surface.base = SheetBase<N>{.reflectance = color * fractions.reflected,
                                .transmittance = color * fractions.transmitted,
                                .sheet = sheet,
                                .place = place,
                                .side = side,
                                .color = color,
                                .beyond = boundary_beyond()};
  } else if (method) {
    const BandValues<N> reflectance = method->local_reflectance(p);
    const bool is_followed = is_from_eye && (!is_inside || is_sheet);
    if (cover && (is_followed || !is_sheet))
      surface.base = covered_translucent<N>(*cover, reflectance, is_followed ? method : nullptr,
                                            surface.at.wo.z);
    else if (is_followed)
      surface.base = TranslucentBase<N>{reflectance, method};
    else if (is_sheet)
      surface.base = DiffuseBase<N>{reflectance, method->local_transmittance(p), boundary_beyond()};
    else
      surface.base = DiffuseBase<N>{reflectance};
  } else if (const auto* layered = world.layered[p.material].get()) {
    LayeredBase<N> base{.reflectance = {},
                        .layers = layered->at(p, surface.at.boundary, surface.at.wo),
                        .mirrored = {}};
    base.reflectance = base.layers->reflectance();
    base.mirrored = base.layers->mirrored_inside();
    const float mirrored = sum(base.mirrored);
    if (world.scene.settings.factors.any()) surface.at.boundary = {};  // mirrors nothing
    base.mirrored_chance = mirrored / (mirrored + sum(base.reflectance) + 1e-6f);
    surface.base = std::move(base);
  }
  return surface;
}

#define LAMINA_INSTANTIATE(N)                                                         \
  template struct DiffuseBase<N>;                                                     \
  template struct LayeredBase<N>;                                                     \
  template struct SheetBase<N>;                                                       \
  template struct CoveredBase<N>;                                                     \
  template PathSurface<N> make_path_surface(const PathWorld<N>&, const SurfacePoint&, \
                                            const Vec3f&, bool)
LAMINA_INSTANTIATE(4);
LAMINA_INSTANTIATE(8);
LAMINA_INSTANTIATE(16);
#undef LAMINA_INSTANTIATE

}  // namespace lamina
