// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "lamina/core/band_values.h"
#include "lamina/render/band_conversion.h"
#include "lamina/render/render_scene.h"
#include "lamina/render/subsurface_transport.h"
#include "lamina/render/walk_lamps.h"
#include "lamina/render/walk_layers.h"
#include "lamina/render/walk_space.h"

namespace lamina {

/// The truth for curved objects that RandomWalk does not take: paths through layers by depth.
///
/// Lamps are sought as RandomWalk does, but nothing is known about the light beforehand: paths are
/// followed to their end.
template <int N>
class MediaWalk final : public SubsurfaceTransport<N> {
 public:
  using Bands = BandValues<N>;

  /// @throws InvalidInput if the indices of layers differ, or a mesh of the material is open
  MediaWalk(const RenderScene& scene, const BandConversion<N>& conversion, std::uint32_t material);

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  /// By diffusion: for light on its way between objects.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    (void)point;
    return layers_.diffuse_reflectance();
  }

 private:
  using Place = DepthLayers::Place;
  [[nodiscard]] Bands walk(const ExitPoint& exit, const Vec3f& inward,
                           const LightGatherer<N>& light, PixelSamples& samples) const;
  /// Follows a path to where it scatters (not yet turned) or leaves, as WalkSpace does; `place` is
  /// that of its origin, then of its end.
  [[nodiscard]] WalkStep advance(WalkPath<N>& path, Place& place, WalkNumbers& numbers) const;
  [[nodiscard]] Bands search(const WalkPath<N>& path, const Place& place,
                             const LightGatherer<N>& light, Random& random) const;

  WalkLayers<N> layers_;
  WalkSpace<N> space_;
  WalkLamps<N> lamps_;
};

}  // namespace lamina
