// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/profile_table.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// The mean of the image that varies a color, as its map has it; white without an image.
[[nodiscard]] Vec3f mean_of_map(const TextureStore& textures, const ColorParameter& color);

/// Medium inside the meshes of a translucent material for a method that follows light inside. Where
/// its color is inverted, the absorption is such that flat layers reflect the mean color.
template <int N>
[[nodiscard]] Material colored_medium(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material);

/// Colors the light of a method whose medium is colored_medium. Where the color is inverted, what
/// leaves is scaled by the color over what the medium reflects: so on flat layers it is met
/// everywhere; how far light spreads follows the mean. Else what leaves is scaled by the color over
/// its mean, spread by the profile of flat layers, and so little that flat layers never send back
/// more than they get.
///
/// Source: [DonnerJensen2005] §3.1.
template <int N>
class ColoredTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material that has a color
  ColoredTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                   std::uint32_t material, std::unique_ptr<SubsurfaceMethod<N>> inside);

  void prepare_reflectance(const Preparation<N>& with) override {
    inside_->prepare_reflectance(with);
  }
  [[nodiscard]] bool prepare(const Preparation<N>& with) override { return inside_->prepare(with); }
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override {
    return inside_->expected_cost(with);
  }
  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override {
    return scale(colored_at(exit.point, samples)) * inside_->leaving_radiance(exit, light, samples);
  }
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

 private:
  [[nodiscard]] Bands scale(const SurfacePoint& point) const;
  /// Where the color of light that leaves at a point is looked up: one that scales at random, by
  /// the profile around it.
  [[nodiscard]] SurfacePoint colored_at(const SurfacePoint& point, PixelSamples& samples) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  std::unique_ptr<SubsurfaceMethod<N>> inside_;
  Vec3f mean_color_;
  Bands reflected_ = Bands::filled(1.0f);  ///< by flat layers of the medium
  std::optional<ProfileTable<N>>
      profile_;  ///< of a color that scales; none if light hardly scatters
};

}  // namespace lamina
