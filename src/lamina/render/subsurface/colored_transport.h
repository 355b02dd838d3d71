// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// The mean of the image that varies a color, as its map has it; white without an image.
[[nodiscard]] Vec3f mean_of_map(const TextureStore& textures, const ColorParameter& color);

/// What fills the meshes of a translucent material for a method that follows light inside. Where
/// its color is inverted, the absorption is such that flat layers reflect the mean color.
template <int N>
[[nodiscard]] Material colored_medium(const RenderScene& scene, const BandConversion<N>& conversion,
                                      std::uint32_t material);

/// Colors the light of a method whose medium is colored_medium: what leaves is scaled, by the color
/// over its mean, or where the color is inverted, by the color over what the medium reflects. So on
/// flat layers an inverted color is met everywhere; how far light spreads follows the mean.
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
    return scale(exit.point) * inside_->leaving_radiance(exit, light, samples);
  }
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

 private:
  [[nodiscard]] Bands scale(const SurfacePoint& point) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::unique_ptr<SubsurfaceMethod<N>> inside_;
  Vec3f mean_color_;
  Bands reflected_ = Bands::filled(1.0f);  ///< by the medium of an inverted color
};

}  // namespace lamina
