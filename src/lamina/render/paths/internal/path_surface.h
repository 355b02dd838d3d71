// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>

#include "lamina/render/paths/path.h"

namespace lamina {

/// An opaque or thin surface seen from `wo`.
template <int N>
struct PathSurface {
  using Bands = BandValues<N>;
  SurfacePoint point;
  SurfaceBoundary boundary;
  Framef frame;
  Vec3f wo;           ///< in the frame
  Bands reflectance;  ///< of the base
  const SubsurfaceMethod<N>* transport = nullptr;

  // Of layers without spread alone:
  std::unique_ptr<LayeredPoint<N>> layered;
  Bands mirrored;                ///< by mirrors below the surface
  float mirrored_chance = 0.0f;  ///< share of them among the light of the base that is drawn

  // Of a thin sheet alone:
  const ThinSheet<N>* sheet = nullptr;
  typename ThinSheet<N>::Place place;
  int side = 0;            ///< that it is seen from
  Bands color;             ///< of the scattered light
  SurfaceBoundary beyond;  ///< the boundary on the other side
  Bands transmittance;     ///< fraction that comes through scattered
  /// Share of light scattered by the base that is drawn from beyond.
  [[nodiscard]] float beyond_chance() const {
    const float t = sum(transmittance);
    return t > 0.0f ? std::clamp(t / (t + sum(reflectance)), 0.05f, 0.95f) : 0.0f;
  }
};

template <int N>
[[nodiscard]] PathSurface<N> make_path_surface(const PathWorld<N>& world, const SurfacePoint& point,
                                               const Vec3f& towards_eye);

// What the base makes of light from wi: its bsdf is lobe * color [1/sr].
template <int N>
[[nodiscard]] float base_lobe(const PathSurface<N>& surface, const Vec3f& wi);
template <int N>
[[nodiscard]] BandValues<N> base_color(const PathSurface<N>& surface, const Vec3f& wi);
/// Density with which `scatter` draws a direction by the base [1/sr].
template <int N>
[[nodiscard]] float pdf_base(const PathSurface<N>& surface, const Vec3f& wi);

/// Chance that a path goes on by the boundary of a surface rather than its base.
template <int N>
[[nodiscard]] float specular_chance(const PathSurface<N>& surface);

/// The normal turned so far towards the eye that it is seen.
[[nodiscard]] Vec3f make_visible(const Vec3f& n, const Vec3f& wo);

/// Whether a direction lies on the same side of the triangle as of the normal that is bent by
/// interpolation and bumps. `point` has its normals on the side of the eye.
[[nodiscard]] bool leaves_by_its_side(const SurfacePoint& point, const Vec3f& direction,
                                      const Vec3f& local);

/// A direction around +z with density cos / pi.
[[nodiscard]] Vec3f sample_cosine_hemisphere(Vec2f u);

}  // namespace lamina
