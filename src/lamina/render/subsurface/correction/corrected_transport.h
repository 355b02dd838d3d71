// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/render/subsurface/correction/internal/correction_fit.h"
#include "lamina/render/subsurface/correction/internal/place_graph.h"
#include "lamina/render/subsurface/correction/internal/sampled_places.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// A planar method, corrected by random walks for what a flat profile makes wrong on a curved
/// surface. At places on the surface a few walks find the light that leaves; over that of the
/// planar method it is a ratio that changes slowly along the surface, and linearly with the
/// direction inside. The planar method is a control variate: its detail stays, and the ratio is
/// smoothed along the surface as far as the noise of the walks asks for.
///
/// Walks take one layer, and maps, as quiet_layers, which spares most of their noise. What flat
/// layers reflect of light that has entered, over what flat quiet ones do, makes up for it: some
/// percent.
///
/// The planar light counts as some more, evenly: a hundredth of the mean, so that light which only
/// the walks find is there, too; or all or ten times of the mean, at places where its detail is
/// wrong, as where light comes through thin and wound parts. Halves of the walks around say which
/// is better.
///
/// Noise-free where the planar method is. The places are those that the camera sees and the walks
/// those towards it, unless the ratio is kept for other cameras: then they are all over the
/// surface, in all directions.
template <int N>
class CorrectedTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param planar  whose light has no noise
  /// @param walk    of the same material as quiet_layers
  CorrectedTransport(const RenderScene& scene, std::uint32_t material,
                     std::unique_ptr<SubsurfaceMethod<N>> planar,
                     std::unique_ptr<SubsurfaceMethod<N>> walk);

  void prepare_reflectance(const Preparation<N>& with) override;
  /// Makes planar light ready, and takes ratios that are kept. Others are found by refine().
  [[nodiscard]] bool prepare(const Preparation<N>& with) override;
  void refine(const Preparation<N>& with) override;
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override;

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    return planar_->local_reflectance(point);
  }
  [[nodiscard]] bool is_sheet(const SurfacePoint& point) const override {
    return planar_->is_sheet(point);
  }
  [[nodiscard]] Bands local_transmittance(const SurfacePoint& point) const override {
    return planar_->local_transmittance(point);
  }

 private:
  /// Number of places that the pixels showing the material can use.
  [[nodiscard]] double places_wanted(const Preparation<N>& with) const;
  /// About how long refine() takes [CPU s], before any walks are timed.
  [[nodiscard]] double seconds_of_refinement(const Preparation<N>& with) const;
  /// Spacing of so many places where the surface is seen [mm].
  [[nodiscard]] float spacing_of_places(const Preparation<N>& with) const;

  /// Walks until there are as many as their noise asks for.
  /// @return  the share of those, less than 1 if progress asked to stop; 0 if too few are there
  [[nodiscard]] double walk(SampledPlaces<N>& places, const Preparation<N>& with) const;
  /// Fits what walks have found. @return  no places if there is no light
  [[nodiscard]] LightRatioCloud fit_ratios(const SampledPlaces<N>& places, float spacing) const;
  /// Takes ratios that were found.
  /// @param share  of the walks that were wanted
  void use(const LightRatioCloud& cloud, double share, PreparationReport& report);

  /// The direction to the eye that the ratio is for, of several the nearest to a direction; where
  /// it is for all, that direction.
  [[nodiscard]] Vec3f direction_to_eye(const Vec3f& position, const Vec3f& direction) const;
  [[nodiscard]] Bands ratio_at(const DirectionalRatio<N>& ratio,
                               const DirectionTerms& terms) const {
    return evaluate(shape_, terms) * evaluate(ratio, terms);
  }

  const RenderScene& scene_;
  std::uint32_t material_;
  int bands_;
  float ior_;                                           ///< inside over outside, mean of the bands
  std::unique_ptr<SubsurfaceMethod<N>> planar_, walk_;  ///< the latter until it is prepared
  Bands flat_over_quiet_;     ///< what flat layers reflect over what quiet ones do
  bool has_layers_;           ///< or maps
  std::vector<Vec3f> eyes_;   ///< that the ratio is for; none: for all
  PlaceGraph graph_;
  AngularShape<N> shape_{};
  std::vector<DirectionalRatio<N>> ratios_;  ///< [place], over the shape
  std::vector<float> added_exitance_;        ///< [place], by which the planar light counts as more
  Bands elsewhere_ = Bands::filled(1.0f);    ///< the ratio, about, where there are no places
};

}  // namespace lamina
