// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lamina/base/core/progress.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

template <int N>
class WalkMedia;
template <int N>
struct BodyMedium;

/// Random walks over media, the reference for curved objects: volumetric path tracing inside closed
/// meshes, through layers by depth, which may be maps, through rough boundaries and from body to
/// body. No profile, no diffusion, no flatness.
///
/// Lights, and what is bright in the sky (LightSeen::next_event_share), are sampled by next-event
/// estimation: from scattering events through a smooth boundary, on the path that Snell's law
/// takes, also through bodies of the same index; from where a path meets a rough boundary. Paths
/// that leave and meet a light share it by multiple importance sampling, so that light on a second
/// way, which next-event estimation misses on a wavy surface, is not lost; in a homogeneous body
/// light vertices find most of that. The rest of the sky and other objects are found by paths that
/// leave.
///
/// A closed body of one homogeneous medium with a smooth boundary, which no other body touches, has
/// a precomputed radiance field: a control variate that spares most of the work. Layers and maps
/// under a smooth boundary have one that some walks learn, by depth. Both are optional parts of the
/// medium: paths follow the same rules with them and without, and have the same mean.
///
/// A coat counts for the light that leaves towards the eye, not inside.
template <int N>
class RandomWalk final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @throws InvalidInput if a mesh of the material is open; if one has several media and the body
  ///         is not homogeneous by itself; for lights without an area over layers of different
  ///         indices; for maps without texture coordinates
  RandomWalk(std::shared_ptr<WalkMedia<N>> media, std::uint32_t material);

  [[nodiscard]] bool prepare(const Preparation<N>& with) override;
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override;

  /// Solves the radiance field, if the medium has one. Without it the mean is the same, at more
  /// work.
  ///
  /// @param scale  of the field: 1, unless to show that the mean is the same with any
  /// @return       false if `progress` asked to stop
  [[nodiscard]] bool solve_radiance_field(const LightGatherer<N>& light, const Progress& progress,
                                          float scale = 1.0f);

  /// Traces light vertices where next-event estimation misses light. Without them the mean is the
  /// same, but for points, spots and distant lights, whose light no path finds then.
  ///
  /// @return  false if `progress` asked to stop
  [[nodiscard]] bool trace_light_vertices(const LightGatherer<N>& light, const Progress& progress);

  /// Lets some walks from points of the surface tell the others what light to expect in layers, if
  /// the medium has them. Without it the mean is the same, at more work.
  ///
  /// @param scale  of what they tell, as in solve_radiance_field
  /// @return       false if `progress` asked to stop
  [[nodiscard]] bool learn_depth_radiance(std::span<const SurfacePoint> points,
                                          const LightGatherer<N>& light, const Progress& progress,
                                          float scale = 1.0f);

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override {
    return radiance(exit, light, samples, true);
  }
  [[nodiscard]] Bands scattered_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                         PixelSamples& samples) const override {
    return radiance(exit, light, samples, false);
  }
  /// Reflectance of flat layers at a point: for indirect light between objects.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

 private:
  [[nodiscard]] Bands radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                               PixelSamples& samples, bool with_unscattered) const;

  std::shared_ptr<WalkMedia<N>> media_;
  std::uint32_t material_;
  BodyMedium<N>* medium_;
  float least_reference_;
};

/// The media inside all closed bodies of a scene, shared by the walks of its materials.
///
/// @param are_quiet  translucent materials as quiet_layers where is_better_quiet
template <int N>
[[nodiscard]] std::shared_ptr<WalkMedia<N>> make_walk_media(const RenderScene& scene,
                                                            const BandConversion<N>& conversion,
                                                            bool are_quiet = false);

}  // namespace lamina
