// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/random_walk/internal/walk_boundary.h"
#include "lamina/render/subsurface/random_walk/internal/walk_media.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/spectrum/band_values.h"

namespace lamina {

/// Whether light inside a material takes MediaWalk: layers, a rough boundary, or meshes that may
/// touch others of translucent or dielectric materials.
[[nodiscard]] bool is_for_media_walk(const RenderScene& scene, std::uint32_t material);

/// The truth for curved objects that RandomWalk does not take: paths through layers by depth,
/// through rough boundaries, and from body to body.
///
/// Lamps and what is bright in the sky are sought as RandomWalk does where the boundary is smooth,
/// through bodies of the same index. Where it is rough, from where a path meets it. Nothing is
/// known about the light beforehand: paths are followed to their end.
template <int N>
class MediaWalk final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param media  shared by the walks of all materials
  /// @throws InvalidInput if a mesh of the material is open, or has several media; for lights
  ///         without an area over layers of different indices
  MediaWalk(std::shared_ptr<const WalkMedia<N>> media, std::uint32_t material);

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  /// That of flat layers: for light on its way between objects.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    (void)point;
    return reflectance_;
  }

 private:
  using Place = MediaPlace<N>;
  using Surface = typename WalkMedia<N>::Surface;
  [[nodiscard]] Bands walk(const ExitPoint& exit, const LightGatherer<N>& light,
                           PixelSamples& samples) const;
  /// What a path comes to: it scatters (not yet turned), meets a surface, or a layer of another
  /// index.
  struct Step {
    enum class End { event, surface, layer, lost } end = End::lost;
    Surface surface;
    std::size_t layer = 0;
  };
  /// Follows a path, by draws as in WalkSpace; `place` is that of its origin, then of its end.
  [[nodiscard]] Step advance(WalkPath<N>& path, Place& place, WalkNumbers& numbers) const;
  /// Turns a path at the boundary to the next layer.
  void meet_layer(WalkPath<N>& path, Place& place, std::size_t next, PixelSamples& samples) const;
  /// A path has turned at a surface.
  void start_anew(WalkPath<N>& path, Place& place) const;

  /// Light that a lamp sends to the last event through the smooth boundary, scattered into the
  /// path.
  [[nodiscard]] Bands search(const WalkPath<N>& path, const Place& place,
                             const LightGatherer<N>& light, Random& random) const;
  /// Light from outside along the turn of a path that leaves by the smooth boundary, less what
  /// searches from the place of the last event find.
  [[nodiscard]] Bands light_outside(const WalkPath<N>& path, const Place& last,
                                    const BoundaryTurn& turn, const SurfacePoint& point,
                                    const LightGatherer<N>& light, PixelSamples& samples) const;
  /// Light that a lamp sends to the rough boundary, refracted into the path.
  [[nodiscard]] Bands search_beyond(const WalkBoundary& boundary, const SurfacePoint& point,
                                    const LightGatherer<N>& light, PixelSamples& samples) const;
  /// Light from outside along the turn of a path that leaves by the rough boundary, less what
  /// searches from there find.
  [[nodiscard]] Bands light_beyond(const BoundaryTurn& turn, const SurfacePoint& point,
                                   const LightGatherer<N>& light, PixelSamples& samples) const;

  std::shared_ptr<const WalkMedia<N>> media_;
  Bands reflectance_;
};

}  // namespace lamina
