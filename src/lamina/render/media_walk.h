// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "lamina/core/band_values.h"
#include "lamina/render/band_conversion.h"
#include "lamina/render/render_scene.h"
#include "lamina/render/subsurface_transport.h"
#include "lamina/render/walk_boundary.h"
#include "lamina/render/walk_lamps.h"
#include "lamina/render/walk_layers.h"
#include "lamina/render/walk_space.h"

namespace lamina {

/// Whether light inside a material takes MediaWalk: layers, or a rough boundary.
[[nodiscard]] bool is_for_media_walk(const SurfaceMaterial& material);

/// The truth for curved objects that RandomWalk does not take: paths through layers by depth, and
/// through rough boundaries.
///
/// Lamps are sought as RandomWalk does where the boundary is smooth. Where it is rough, from where
/// a path meets it. Nothing is known about the light beforehand: paths are followed to their end.
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
  [[nodiscard]] Bands walk(const ExitPoint& exit, const LightGatherer<N>& light,
                           PixelSamples& samples) const;
  /// What a path comes to: it scatters (not yet turned), or meets a surface.
  struct Step {
    enum class End { event, surface, lost } end = End::lost;
    Hit hit;
  };
  /// Follows a path, by draws as in WalkSpace; `place` is that of its origin, then of the event.
  [[nodiscard]] Step advance(WalkPath<N>& path, Place& place, WalkNumbers& numbers) const;
  /// Light that a lamp sends to the last event through the smooth boundary, scattered into the
  /// path.
  [[nodiscard]] Bands search(const WalkPath<N>& path, const Place& place,
                             const LightGatherer<N>& light, Random& random) const;
  /// Light that a lamp sends to the rough boundary, refracted into the path.
  [[nodiscard]] Bands search_beyond(const WalkBoundary& boundary, const SurfacePoint& point,
                                    const LightGatherer<N>& light, PixelSamples& samples) const;
  /// Light from outside along the turn of a path that leaves: through the smooth boundary, less
  /// what searches from the place of the last event find; through the rough one, less what those
  /// from the boundary do.
  [[nodiscard]] Bands light_outside(const WalkPath<N>& path, const Place& last,
                                    const BoundaryTurn& turn, const SurfacePoint& point,
                                    const LightGatherer<N>& light, PixelSamples& samples) const;
  [[nodiscard]] Bands light_beyond(const BoundaryTurn& turn, const SurfacePoint& point,
                                   const LightGatherer<N>& light, PixelSamples& samples) const;

  WalkLayers<N> layers_;
  WalkSpace<N> space_;
  WalkLamps<N> lamps_;
  Interface facets_;  ///< of the boundary
  bool is_rough_;
};

}  // namespace lamina
