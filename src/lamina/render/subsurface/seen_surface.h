// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/scene/surface/surface_point.h"

namespace lamina {

/// Points of translucent surfaces that a picture shows: found by rays from the camera, one to a
/// pixel but no more than half a million, through glass and holes as they go in the picture.
struct SeenSurface {
  std::vector<std::vector<SurfacePoint>> points;  ///< [material], in no order
  std::size_t rays = 0;
  float pixels_between = 1.0f;        ///< neighbouring rays
  double seconds_per_ray = 0.0;       ///< with all that it mirrors, but no light from below [CPU s]
  double seconds_per_estimate = 0.0;  ///< of the light that enters where a surface is seen [CPU s]

  [[nodiscard]] std::size_t count() const;
  /// Width of a pixel on a material [mm] where it comes close: but a twentieth of the points is
  /// seen as finely. 0 if nothing of it is seen.
  [[nodiscard]] float pixel_size(std::uint32_t material) const;
  /// About how much of a material's surface is seen [mm²]: pixels see it at a slant.
  [[nodiscard]] double area(std::uint32_t material) const;
};

}  // namespace lamina
