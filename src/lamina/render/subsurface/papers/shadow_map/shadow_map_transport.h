// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lamina/render/subsurface/papers/shadow_map/internal/shadow_buffer.h"
#include "lamina/render/subsurface/preparation.h"
#include "lamina/render/subsurface/profiles/gather_profiles.h"
#include "lamina/render/subsurface/profiles/material_profiles.h"

namespace lamina {

/// A radius that is drawn, and the density of points in the plane there.
struct SampledRadius {
  float r;        ///< [mm]
  float density;  ///< [1/mm²]
};

/// Subsurface transport by what lights see of the surface, kept in shadow buffers.
///
/// Every view of a light makes a picture of the surface: depth, normals, and how much light enters.
/// Where light leaves, points are drawn by the profile in the plane across the light, around the
/// point where it leaves, and each is moved along the light to the surface that the light sees. In
/// that plane flux is even, whatever the surface below is like, so the cosine at the
/// surface is in the measure already, and no sample weighs more than the profile's total: it can
/// only be further from the exit than it was in the plane.
///
/// The profiles, how they are blended by normals and thinned, and how colors count are those of
/// HierarchyTransport. Left out is light from other surfaces; soft lights and the sky are sums over
/// a set of views. An opaque object inside stops the light that would cross it on its way straight
/// from the light to below the surface.
///
/// Source: [Hery2003] §3, §5.1, §5.2. Departures: all bands share the points by the sum of their
/// profiles; other objects' shadow is kept with each texel instead of scaling the result.
template <int N>
class ShadowMapTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the transport
  ShadowMapTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                     std::uint32_t material, const ProfileMaker& make_profile,
                     bool is_printed_exit);

  /// Makes the buffers.
  [[nodiscard]] bool prepare(const Preparation<N>& with) override;
  [[nodiscard]] SubsurfaceCost expected_cost(const Preparation<N>& with) const override;

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    return profiles_.local_reflectance(point);
  }

 private:
  using Buffer = ShadowBuffer<N>;
  using Local = typename MaterialProfiles<N>::Local;
  void make_buffers();
  void fill_texel(Buffer& buffer, std::size_t texel, const LightGatherer<N>& light) const;
  [[nodiscard]] float nearest_blocker(const Ray& ray, const Hit& entry) const;

  [[nodiscard]] SampledRadius sample_reflected(const Local& local, const RadiusMixture<N>& radii,
                                               float u) const;
  [[nodiscard]] SampledRadius sample_passing(const Local& local, float u) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  bool is_alone_, has_opaque_;
  bool is_printed_exit_;
  MaterialProfiles<N> profiles_;
  GatherProfiles<N> gather_profiles_;
  std::vector<float> r2_of_fraction_;  ///< [fraction of the light within r²] of the material [mm²]
  /// [slab], the same of what passes; empty where nothing does.
  std::vector<std::vector<float>> r2_of_passing_;
  std::vector<Buffer> buffers_;
  std::vector<Bands> strength_;     ///< [buffer]
  std::vector<float> chance_ends_;  ///< [buffer], cumulative, ends at 1
};

}  // namespace lamina
