// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lamina/io/disk_cache.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/irradiance_cloud.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"
#include "lamina/scattering/heterogeneous/surface_transport.h"

namespace lamina {

/// Subsurface transport in texture space, through layers whose numbers are maps.
///
/// The surface is cut into texels, the light that enters each is found, and light scatters from
/// texel to texel through the layers with the profiles that the maps give each of them,
/// over the borders of charts as within them. What leaves is looked up where the eye looks. So
/// everything is done once, for any camera; detail is that of the texels.
///
/// Source: [Donner2008] §4; docs/heterogeneous_skin.md.
template <int N>
class TextureSpaceTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the transport.
  /// @throws InvalidInput if its boundary to the ground is rough.
  TextureSpaceTransport(const RenderScene& scene, std::uint32_t material, bool is_printed_exit);

  /// Cuts the surface into texels and takes the light that is kept, or works out what the
  /// layers are at each of them.
  /// @throws InvalidInput if no texel lies on the material, as TextureAtlas, LightCache::find
  void prepare_reflectance(const Preparation<N>& with) override;

  /// Samples the light on the texels and lets it scatter from texel to texel, unless it was kept.
  /// Kept light serves until a pixel sees half a texel. Without a cache, what this camera does not
  /// see is sampled sparingly.
  [[nodiscard]] bool prepare(const Preparation<N>& with) override;
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override;

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

 private:
  /// The width of texels that the settings ask for, never more than `max_texels` of them [mm].
  ///
  /// @param pixel_size  what a pixel sees at least [mm]: texels need not be smaller
  [[nodiscard]] float spacing_for(float pixel_size) const;

  /// Cuts the surface into texels. Comes before all else.
  /// @param spacing  of the texels [mm]
  /// @throws InvalidInput as TextureAtlas, or if no texel lies on the material.
  void make_texels(float spacing);

  /// Works out what the layers are at each texel. Comes before sample_light.
  /// @param cache  of tables
  void make_layers(const std::optional<DiskCache>& cache);

  /// What the operators of the layers are scaled to: radiative transfer, but for skin whose
  /// constants are for diffusion.
  [[nodiscard]] OperatorTotals texture_space_totals() const;

  /// Samples the light on the texels.
  ///
  /// @param is_seen  [texel] whether it shows; others get fewer samples. Empty: all do.
  /// @return         nothing if progress asked to stop
  [[nodiscard]] std::optional<IrradianceCloud> sample_light(const LightGatherer<N>& light,
                                                            const std::vector<bool>& is_seen,
                                                            std::uint64_t seed,
                                                            const Progress& progress) const;

  /// Lets light that was sampled scatter, and forgets the layers.
  void scatter(IrradianceCloud& cloud);

  /// Takes light that has scattered. Comes before leaving_radiance.
  /// @throws InvalidInput if it is of other texels.
  void use(const IrradianceCloud& cloud);

  [[nodiscard]] Bands looked_up(const CellField<N>& field, const SurfacePoint& point) const;
  /// Adds the border texels to a field of texels.
  void extend(CellField<N>& field) const;

  /// Why light that is kept cannot serve this picture; empty: it can.
  [[nodiscard]] std::string misfit(const IrradianceCloud& cloud, const CameraRays& camera) const;

  const RenderScene& scene_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  bool is_printed_exit_;
  float spacing_ = 0.0f;
  bool is_kept_ = false;  ///< the light
  std::optional<TextureAtlas> atlas_;
  CellGraph graph_;
  std::optional<SurfaceLayers<N>> layers_;
  CellField<N> reflectance_, exitance_;  ///< [texel, border texels too]
};

}  // namespace lamina
