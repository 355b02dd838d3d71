// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lamina/render/film/render_options.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/covering.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/shading/thin_sheet.h"
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/scene/surface/ray.h"

namespace lamina {

/// Candidates of resampled importance sampling: light samples that are weighed without shadows, to
/// trace one of them.
inline constexpr int light_candidates = 4;

/// Number of candidates, in MIS weights, that product importance sampling of the specular lobe
/// counts as. Any number gives the same picture, this one little noise.
inline constexpr float product_sampling_candidates = 32.0f;

struct PathOptions {
  int max_bounces = 4;  ///< of light between surfaces
  RenderOptions::DirectLight direct_light = RenderOptions::DirectLight::combined;
};

/// Scene with all that was prepared for its materials, which paths of light travel through. All
/// must outlive it.
template <int N>
struct PathWorld {
  const RenderScene& scene;
  const BandConversion<N>& conversion;
  // One entry per material, null where it is not translucent, none for its BSDF alone, not thin, or
  // not covered:
  const SubsurfaceMethods<N>& transports;
  const LayeredMaterials<N>& layered;
  const ThinSheets<N>& sheets;
  const Coverings<N>& coverings;
  PathOptions options;
};

/// A path on its way back from the eye.
template <int N>
struct PathState {
  Ray ray;
  float t_near = 0.0f;  ///< from where along the ray surfaces count [mm]
  BandValues<N> radiance;
  BandValues<N> throughput = BandValues<N>::filled(1.0f);
  int bounce = 0;
  float pdf = 0.0f;        ///< with which its direction was sampled [1/sr]; 0: a delta direction
  float spread = 0.0f;     ///< growth of the footprint with distance [rad]
  float footprint = 0.0f;  ///< at the origin of the ray [mm]
  float index = 1.0f;      ///< refractive index of what it is in, known on paths from the eye
  float candidates = light_candidates;  ///< of next-event estimation where it was scattered last
  bool is_camera_ray = false;           ///< straight from the camera
  bool is_from_eye = false;             ///< from the camera, maybe through glass
  bool is_from_inside = false;  ///< straight from a point inside that has next-event estimation
  bool is_scattered = false;    ///< by a surface that is no mirror
  bool is_specular = false;     ///< continued by the boundary of the last surface
};

}  // namespace lamina
