// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "lamina/render/paths/path.h"

namespace lamina {

/// A point of a surface and the boundary over its base, seen from `wo`.
struct BoundaryPoint {
  SurfacePoint point;  ///< its normals on the side of wo
  SurfaceBoundary boundary;
  Framef frame;
  Vec3f wo;  ///< in the frame

  /// Chance that a path is continued by the boundary rather than a base of this reflectance.
  [[nodiscard]] float specular_chance(float base_reflectance) const;
};

// The bases of surfaces. Those that scatter light where it enters have
//
//   evaluate(at, wi, samples)   its BSDF for light from wi, which may be a random estimate, and the
//                               density with which sample() draws wi, delta directions left out
//   sample(at, u, chance, u2, samples)   a direction of light, by u in [0, chance) and u2
//   pdf(wi), estimate(at, wi)   that density and the gray BSDF, at least about and not random: for
//                               resampling lights
//   is_random()                 whether evaluate() is an estimate whose pdf holds for its own
//                               sample alone
//   continuous_chance()         share of what sample() draws that is not a delta direction
//   reflectance, scattered()    albedo; all light that it scatters, on both sides
//   is_subsurface               whether that light comes from below the surface

template <int N>
struct BaseValue {
  BandValues<N> bsdf;  ///< [1/sr]
  float pdf = 0.0f;    ///< [1/sr]
};

template <int N>
struct BaseSample {
  Vec3f wi;
  std::optional<BaseValue<N>> value;          ///< if sampling has to know it anyway
  std::optional<BandValues<N>> delta_weight;  ///< of a delta direction: bsdf * cos / probability
};

/// A diffuse reflector of the light that passes the boundary, and the inner side of open meshes.
/// One that transmits, too, is a sheet as paths of indirect light take it.
template <int N>
struct DiffuseBase {
  static constexpr bool is_subsurface = false;
  BandValues<N> reflectance;
  BandValues<N> transmittance = {};  ///< of light that has entered on the other side
  SurfaceBoundary beyond = {};       ///< the boundary there

  [[nodiscard]] BaseValue<N> evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples& samples) const;
  [[nodiscard]] std::optional<BaseSample<N>> sample(const BoundaryPoint& at, float u, float chance,
                                                    Vec2f u2, PixelSamples& samples) const;
  [[nodiscard]] float pdf(const Vec3f& wi) const;
  [[nodiscard]] float estimate(const BoundaryPoint& at, const Vec3f& wi) const;
  [[nodiscard]] bool is_random() const { return false; }
  [[nodiscard]] float continuous_chance() const { return 1.0f; }
  [[nodiscard]] BandValues<N> scattered() const { return reflectance + transmittance; }
};

/// A translucent object whose inside is followed by a method of subsurface transport. No direction
/// is sampled: the method gathers the light that enters elsewhere.
template <int N>
struct TranslucentBase {
  BandValues<N> reflectance;
  const SubsurfaceMethod<N>* method;
};

/// Layers whose light leaves where it enters: method layered_bsdf.
template <int N>
struct LayeredBase {
  static constexpr bool is_subsurface = true;
  BandValues<N> reflectance;
  std::unique_ptr<LayeredPoint<N>> layers;
  BandValues<N> mirrored;        ///< by mirrors below the surface
  float mirrored_chance = 0.0f;  ///< share of them in the light of the base that is sampled

  [[nodiscard]] BaseValue<N> evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples& samples) const;
  [[nodiscard]] std::optional<BaseSample<N>> sample(const BoundaryPoint& at, float u, float chance,
                                                    Vec2f u2, PixelSamples& samples) const;
  [[nodiscard]] float pdf(const Vec3f& wi) const;
  [[nodiscard]] float estimate(const BoundaryPoint& at, const Vec3f& wi) const;
  [[nodiscard]] bool is_random() const { return layers->is_random(); }
  [[nodiscard]] float continuous_chance() const { return 1.0f - mirrored_chance; }
  [[nodiscard]] BandValues<N> scattered() const { return reflectance; }
};

/// A thin sheet, which scatters light to both sides.
template <int N>
struct SheetBase {
  static constexpr bool is_subsurface = false;
  BandValues<N> reflectance, transmittance;  ///< fractions that are scattered back and through
  const ThinSheet<N>* sheet;
  typename ThinSheet<N>::Place place;
  int side = 0;            ///< that it is seen from
  BandValues<N> color;     ///< of the scattered light
  SurfaceBoundary beyond;  ///< the boundary on the other side

  [[nodiscard]] BaseValue<N> evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples& samples) const;
  [[nodiscard]] std::optional<BaseSample<N>> sample(const BoundaryPoint& at, float u, float chance,
                                                    Vec2f u2, PixelSamples& samples) const;
  [[nodiscard]] float pdf(const Vec3f& wi) const;
  [[nodiscard]] float estimate(const BoundaryPoint& at, const Vec3f& wi) const;
  [[nodiscard]] bool is_random() const { return false; }
  [[nodiscard]] float continuous_chance() const { return 1.0f; }
  [[nodiscard]] BandValues<N> scattered() const { return reflectance + transmittance; }

 private:
  [[nodiscard]] float lobe(const BoundaryPoint& at, const Vec3f& wi) const;
};

/// A matte or translucent surface with thin coverings on it, which scatter light by themselves,
/// too.
template <int N>
struct CoveredBase {
  BandValues<N> reflectance;  ///< of coverings and base together
  CoverAt<N> cover;
  BandValues<N> matte;     ///< reflectance of a matte base; 0 of others
  BandValues<N> returned;  ///< of the light that comes down through the coverings, what others send
                           ///< up where it came; 0 where a method gathers it
  const SubsurfaceMethod<N>* method = nullptr;  ///< null where there is none
  BandValues<N> leaving;  ///< with a method: the factor on the light that it finds
  bool is_subsurface = false;

  [[nodiscard]] BaseValue<N> evaluate(const BoundaryPoint& at, const Vec3f& wi,
                                      PixelSamples& samples) const;
  [[nodiscard]] std::optional<BaseSample<N>> sample(const BoundaryPoint& at, float u, float chance,
                                                    Vec2f u2, PixelSamples& samples) const;
  [[nodiscard]] float pdf(const Vec3f& wi) const;
  [[nodiscard]] float estimate(const BoundaryPoint& at, const Vec3f& wi) const;
  [[nodiscard]] bool is_random() const { return false; }
  [[nodiscard]] float continuous_chance() const { return 1.0f; }
  [[nodiscard]] BandValues<N> scattered() const { return reflectance; }

 private:
  [[nodiscard]] BandValues<N> scattered_to(float cos_i, float cos_o) const;
};

/// A surface that ends a path's ray: a boundary over one of five bases. Dielectrics are none of
/// them: paths pass them without a bounce (path_dielectric.cpp).
template <int N>
struct PathSurface {
  BoundaryPoint at;
  std::variant<DiffuseBase<N>, TranslucentBase<N>, LayeredBase<N>, SheetBase<N>, CoveredBase<N>>
      base;

  [[nodiscard]] BandValues<N> reflectance() const {
    return std::visit([](const auto& kind) { return kind.reflectance; }, base);
  }
};

/// @param is_from_eye  whether translucent objects are followed inside; else they are diffuse ones
///                     of the same reflectance.
template <int N>
[[nodiscard]] PathSurface<N> make_path_surface(const PathWorld<N>& world, const SurfacePoint& point,
                                               const Vec3f& towards_eye, bool is_from_eye);

/// The normal turned so far towards the eye that it is seen.
[[nodiscard]] Vec3f make_visible(const Vec3f& n, const Vec3f& wo);

/// Whether a direction lies on the same side of the triangle as of the normal that is bent by
/// interpolation and bumps. `point` has its normals on the side of the eye.
[[nodiscard]] bool leaves_by_its_side(const SurfacePoint& point, const Vec3f& direction,
                                      const Vec3f& local);

}  // namespace lamina
