// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/geometry/ray_geometry.h"
#include "lamina/render/lights/light_views.h"

namespace lamina {

/// The picture that a view of a light has of a box: a grid of rays, parallel if the light is far
/// away, else spread over the directions in which the box is seen, each with the same solid angle.
class ShadowGrid {
 public:
  /// @param low, high  corners of the box [mm]
  /// @param texels     about as many as there are to be, > 0
  ShadowGrid(const LightView& view, const Vec3f& low, const Vec3f& high, int texels);

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  }
  /// The ray through the middle of a texel. It starts at the light, or above the box.
  [[nodiscard]] Ray ray(std::size_t texel) const;
  /// Width of a texel at a distance along its ray [mm].
  [[nodiscard]] float width(float distance) const {
    return is_far_ ? texel_width_ : texel_width_ * distance;
  }

  static constexpr std::size_t outside = ~std::size_t{0};
  struct Place {
    std::size_t texel = outside;
    Ray ray;                ///< through the point itself; its origin relative to that of the grid
    float distance = 0.0f;  ///< of the point along it [mm]
  };
  /// Where a point is seen.
  [[nodiscard]] Place find(const Vec3f& point) const;

  [[nodiscard]] const Vec3f& origin() const { return origin_; }

 private:
  /// On the plane or map that the texels divide.
  [[nodiscard]] Vec2f project(const Vec3f& offset, float distance) const;

  bool is_far_;
  Vec3f origin_;  ///< the light, or the top of the box
  Framef frame_;  ///< z away from the light
  Vec2f low_, texel_;
  int columns_ = 1, rows_ = 1;
  float texel_width_ = 1.0f;  ///< [mm], or [rad] of a light that is near
};

/// The surface that a view of a light sees, as in a shadow map with normals: depth, normals, and
/// what becomes of the light there.
///
/// Source: [Hery2003] §3. Departure: between the middles of texels depth follows the facet that
/// was seen, so that a lit surface is where it is, however coarse the buffer.
template <int N>
struct ShadowBuffer {
  struct Texel {
    float distance = std::numeric_limits<float>::infinity();  ///< [mm]; infinite: nothing there
    float blocker = std::numeric_limits<float>::infinity();   ///< of an opaque object behind it
    float plane = 0.0f;   ///< of the facet that is seen: its normal times the offset from the grid
    Vec3f facet, normal;  ///< flat and smooth, unit length
    BandValues<N> entering;  ///< fraction of the light that passes other objects and the boundary
  };
  LightView view;
  ShadowGrid grid;
  std::vector<Texel> texels;
  std::vector<BandValues<N>> albedo_index;  ///< [texel], see GatherProfiles; empty unless inverted
};

/// Distance along a ray from the light to the facet that a texel has seen [mm].
template <int N>
[[nodiscard]] float facet_distance(const ShadowBuffer<N>& buffer, const ShadowGrid::Place& place) {
  const auto& texel = buffer.texels[place.texel];
  const float cos_facet = dot(texel.facet, place.ray.direction);
  if (!(cos_facet < 0.0f)) return texel.distance;
  const float distance = (texel.plane - dot(texel.facet, place.ray.origin)) / cos_facet;
  // A facet that is seen edge-on would reach far beyond its texel.
  const float most = 4.0f * buffer.grid.width(texel.distance);
  return std::clamp(distance, texel.distance - most, texel.distance + most);
}

}  // namespace lamina
