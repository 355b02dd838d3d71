// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/shading/thin_sheet.h"

namespace lamina {

/// Fraction of the surface that is there at a point; 1 unless the material is cut out by a map.
[[nodiscard]] float opacity_at(const RenderScene& scene, const SurfacePoint& point);

/// Transmittance straight through a thin surface at a point: boundary and layers, holes left out.
template <int N>
[[nodiscard]] BandValues<N> straight_through(const RenderScene& scene, const ThinSheet<N>& sheet,
                                             const SurfacePoint& point, const Vec3f& direction);

enum class Dielectrics {
  block,     ///< light is followed through them by the path itself
  transmit,  ///< what they do not reflect, unbent: for light on other surfaces their focusing
             ///< is left out, which keeps the image clean
};

/// Shadow transmittance: the fraction of light that comes straight through between the start of a
/// ray and a distance along it. 0 behind an opaque surface, the holes of one that is cut out, and
/// what crosses thin sheets without being scattered.
template <int N>
[[nodiscard]] BandValues<N> shadow_transmittance(const RenderScene& scene,
                                                 const ThinSheets<N>& sheets, const Ray& ray,
                                                 float t_far, Dielectrics dielectrics);

}  // namespace lamina
