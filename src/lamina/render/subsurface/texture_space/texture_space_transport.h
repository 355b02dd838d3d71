// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/io/disk_cache.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/irradiance_cloud.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/render/subsurface/texture_space/internal/band_layers.h"
#include "lamina/render/subsurface/texture_space/internal/far_sides.h"
#include "lamina/render/subsurface/texture_space/internal/texture_atlas.h"
#include "lamina/solve/scattering/heterogeneous/surface_transport.h"

namespace lamina {

/// Subsurface transport in texture space, through layers whose numbers are maps.
///
/// The surface is cut into texels, the light that enters each is found, and light scatters from
/// texel to texel through the layers with the profiles that the maps give each of them,
/// over the borders of charts as within them. What leaves is looked up where the eye looks. So
/// everything is done once, for any camera; detail is that of the texels.
///
/// Finite layers without a ground let light through. On an open mesh, a sheet, it leaves at the
/// other side of the same texel, and light enters there, too, by the layers in reverse order. On a
/// closed mesh, which such layers fill, it leaves at the texel opposite.
///
/// Source: [Donner2008] §4; docs/subsurface_texture_space.md.
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
  [[nodiscard]] bool is_sheet(const SurfacePoint& point) const override {
    return is_sheet_[point.mesh];
  }
  [[nodiscard]] Bands local_transmittance(const SurfacePoint& point) const override;

 private:
  /// Fields of one side of the surface, [texel, border texels too].
  struct SideFields {
    CellField<N> exitance, reflectance;
    CellField<N> transmittance;  ///< of light from the other side
  };

  /// Sides of the surface that light enters: 2 if some of it is a sheet.
  [[nodiscard]] std::size_t side_count() const { return sides_.size(); }

  /// The width of texels that the settings ask for, never more than `max_texels` of them [mm].
  ///
  /// @param pixel_size  what a pixel sees at least [mm]: texels need not be smaller
  [[nodiscard]] float spacing_for(float pixel_size) const;

  /// Cuts the surface into texels. Comes before all else.
  /// @param spacing  of the texels [mm]
  /// @throws InvalidInput as TextureAtlas, or if no texel lies on the material.
  void make_texels(float spacing);

  /// Layers at each texel.
  struct TexelLayers {
    CellGraph graph;
    std::vector<SurfaceLayers<N>> layers;  ///< [side], over `graph`; one, if both are alike
    std::vector<CellField<N>> reflectance;    ///< [side], in even light, border texels too
    std::vector<CellField<N>> transmittance;  ///< [side], where there are two
    std::vector<FarSide> far_sides;           ///< [texel], of layers that let light through
    std::string warning;                      ///< if light is lost; else empty

    [[nodiscard]] const SurfaceLayers<N>& from(std::size_t side) const {
      return layers[std::min(side, layers.size() - 1)];
    }
  };

  /// Light on texels, and which.
  struct TexelLight {
    std::uint64_t texels = 0;  ///< key of the kept ones
    IrradianceCloud cloud;
  };

  /// Takes over texels and what is known of their light, or makes texels and their layers.
  void take_or_make_layers(const Preparation<N>& with);

  /// Works out what the layers are at each texel. Comes before sample_light.
  /// @param cache  of tables
  [[nodiscard]] std::shared_ptr<const TexelLayers> make_layers(
      const std::optional<DiskCache>& cache) const;

  /// Adds what comes through from other sides of an infinite last layer.
  /// @param bands  of `layers`
  void add_thin_parts(std::span<const BandLayers> bands, const CellGraph& graph,
                      SurfaceLayers<N>& layers) const;

  /// Totals that the operators of the layers are scaled to: radiative transfer, but for skin whose
  /// constants are for diffusion.
  [[nodiscard]] OperatorTotals texture_space_totals() const;

  /// Samples the light on the texels, side by side.
  ///
  /// @param is_seen  [texel] whether its light shows; others get fewer samples. Empty: all do.
  /// @return         nothing if progress asked to stop
  [[nodiscard]] std::optional<IrradianceCloud> sample_light(const LightGatherer<N>& light,
                                                            const std::vector<bool>& is_seen,
                                                            std::uint64_t seed,
                                                            const Progress& progress) const;

  /// Lets light that was sampled scatter, and lets go of the layers.
  void scatter(IrradianceCloud& cloud);

  /// Adds light that has passed the layers to what leaves on the other side.
  /// @param side     where it entered
  /// @param through  [texel] flux that leaves below that side, per area
  /// @param leaving  [side][texel]
  void add_transmitted(std::size_t side, CellField<N> through,
                       std::vector<CellField<N>>& leaving) const;

  /// Takes light that has scattered. Comes before leaving_radiance.
  /// @throws InvalidInput if it is of other texels.
  void use(const IrradianceCloud& cloud);

  [[nodiscard]] const SideFields& side_of(const SurfacePoint& point) const {
    return sides_[point.is_below ? 1 : 0];
  }
  [[nodiscard]] static Bands looked_up(const CellField<N>& field,
                                       const TextureAtlas::Weights& weights);
  /// Adds the border texels to a field of texels.
  void extend(CellField<N>& field) const;

  /// Why light that is kept cannot serve this picture; empty: it can.
  [[nodiscard]] CloudMisfit misfit(const IrradianceCloud& cloud, const CameraRays& camera) const;

  const RenderScene& scene_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  bool is_printed_exit_;
  float spacing_ = 0.0f;
  bool is_kept_ = false;  ///< the light
  std::shared_ptr<const TextureAtlas> atlas_;
  std::uint64_t texels_key_ = 0;  ///< of the atlas, where it is kept
  std::vector<bool> is_sheet_;    ///< [mesh]
  std::vector<SideFields> sides_;                    ///< [side]
  std::shared_ptr<const TexelLayers> texel_layers_;  ///< until light has scattered
};

}  // namespace lamina
