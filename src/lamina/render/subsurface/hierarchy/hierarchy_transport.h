// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/render/subsurface/hierarchy/internal/inner_blockers.h"
#include "lamina/render/subsurface/hierarchy/internal/irradiance_tree.h"
#include "lamina/render/subsurface/irradiance_cloud.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/profiles/gather_profiles.h"
#include "lamina/render/subsurface/profiles/material_profiles.h"
#include "lamina/render/subsurface/spacing_field.h"
#include "lamina/scene/surface/point_grid.h"

namespace lamina {

/// How the light on a material is sampled.
struct LightSampling {
  SpacingField field;
  int estimates = 32;  ///< of the light at each sample
  double cells = 0.0;  ///< samples, about: all, and close ones
  double close_cells = 0.0;
};

/// Subsurface transport by summing a profile over samples of the light on the surface.
///
/// First the surface is cut into patches, narrower than the profile where they are seen, and the
/// light that enters each is found. Then the light that leaves at a point is a sum over all patches
/// within the support radius of the profile, those far away many at a time. The sum has no noise,
/// and the samples serve any camera. It is as smooth as the profile is wide, so it is taken at the
/// patches that are seen, once, and between them interpolated.
///
/// The profiles are those of ProbeTransport, with the same assumptions: what it draws at random
/// is summed here. Detail of the light finer than the spacing of the samples is blurred, and so is
/// that of a color that scales it; that of an inverted color is kept.
///
/// Opaque objects inside stop light: the sum is scaled by the fraction that InnerBlockers finds.
///
/// Source: [JensenBuhler2002]; [Hery2003] §4 for inverting colors at each sample, §5.2 for objects
/// inside.
template <int N>
class HierarchyTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the transport
  HierarchyTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                     std::uint32_t material, const ProfileMaker& make_profile,
                     bool is_printed_exit);

  /// Samples the light on the surface, or takes what is kept of it, and makes it ready to be
  /// summed. Where the settings ask for it samples are made twice as close, from four times as far
  /// apart, until the light that leaves hardly changes. Samples that are kept are twice as close as
  /// this camera needs, so that others may come nearer; one that needs closer ones makes them.
  /// @throws as LightCache::find
  [[nodiscard]] bool prepare(const Preparation<N>& with) override;
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override;

  /// Plans spacing and estimates as fine as the picture can show: pixels, samples of a pixel, and
  /// what of the surface is seen at all. Where the settings state the spacing, ask for refinement,
  /// or samples are kept for other cameras, the surface is sampled evenly.
  [[nodiscard]] LightSampling plan_sampling(const CameraRays& camera, const SeenSurface& seen,
                                            bool is_kept) const;

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    return profiles_.local_reflectance(point);
  }

  /// An opaque object inside, bones say, by a coarse look: most of a scene are elsewhere.
  struct Inside {
    std::vector<Mesh> mesh;
    std::uint32_t material;
    double area, fraction;  ///< of it that lies inside, about [mm²], and over all of it
  };
  [[nodiscard]] std::vector<Inside> objects_inside() const;

 private:
  using Local = typename MaterialProfiles<N>::Local;

  /// The spacing of samples that the settings ask for, never more than `max_points` of them [mm].
  ///
  /// @param pixel_size  what a pixel sees [mm]: samples need not be closer
  [[nodiscard]] float spacing_for(float pixel_size) const;
  /// Spacing of `max_points` samples all over the surface [mm].
  [[nodiscard]] float closest_spacing() const;

  /// Samples the light on the surface.
  ///
  /// @param estimates  of the light at each sample, at random
  /// @return           nothing if progress asked to stop
  [[nodiscard]] std::optional<IrradianceCloud> sample_light(const LightGatherer<N>& light,
                                                            const SpacingField& field,
                                                            int estimates, std::uint64_t seed,
                                                            const Progress& progress) const;

  /// Samples the light and uses it from then on; returns the samples, if any were made.
  [[nodiscard]] std::optional<IrradianceCloud> sample_and_use(const Preparation<N>& with,
                                                              const LightSampling& sampling,
                                                              LightSamples& done);
  /// Makes the samples ready to be summed. Comes before exitance.
  void use(const IrradianceCloud& cloud);
  /// Flux per area that leaves at a point, and at some.
  [[nodiscard]] Bands exitance(const SurfacePoint& point) const;
  [[nodiscard]] std::vector<Bands> exitance_at(const std::vector<SurfacePoint>& points) const;

  /// By a sum over all samples within the support radius.
  [[nodiscard]] Bands summed_exitance(const Vec3f& position, const Vec3f& normal,
                                      const Local& local) const;
  /// The surface of opaque objects inside; and that of this one if it can be covered by patches not
  /// much wider than a mean free path.
  struct BlockerPatches {
    std::vector<typename InnerBlockers<N>::Patch> inner, outer;
  };
  [[nodiscard]] BlockerPatches blocker_patches(float spacing, float mfp) const;
  [[nodiscard]] std::vector<typename InnerBlockers<N>::Patch> patches_inside(
      const std::vector<Mesh>& mesh, std::uint32_t material, float spacing) const;
  [[nodiscard]] bool is_inside(const Vec3f& position, const Vec3f& normal) const;
  /// Exitance at a sample, over what an inverted color there makes of it.
  [[nodiscard]] Bands exitance_without_color(const CloudPoint& point) const;
  [[nodiscard]] Bands effect_of_color(const Vec3f& color) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  bool is_printed_exit_;
  MaterialProfiles<N> profiles_;
  IrradianceTree<N> tree_;
  InnerBlockers<N> blockers_;
  GatherProfiles<N> gather_profiles_;
  float support_radius_ = 0.0f, width_ = 0.0f;  ///< [mm]
  std::vector<CloudPoint> points_;
  PointGrid grid_;
  mutable LazyValues<BandValues<N>> exitance_;  ///< [point]
};

}  // namespace lamina
