// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lamina/render/subsurface/profiles/material_profiles.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// Subsurface transport by the profile of a flat layered slab, laid over the real surface.
///
/// From the point where light leaves, probe rays are sent through the object at radii drawn from
/// the profile, along the normal and now and then a tangent; one of their hits is where the light
/// entered. All points within the support radius of the profile can be found along at least one
/// axis, and a point counts with the density of all three.
///
/// Holds for surfaces that are flat over a mean free path and for objects without holes inside.
///
/// Source: [DonnerJensen2005] Eqs. 25, 27; the three axes [King2013]. Departures: there the axes
/// are combined by the balance heuristic, which on a gently curved surface lets grazing probes
/// along the tangents spoil the even samples of the normal; here each point belongs to one axis.
/// The normal that probes start from is the smooth one, since a bump map's would throw them off; of
/// several hits one is drawn by its weight.
template <int N>
class ProbeTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the transport
  ProbeTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                 std::uint32_t material, const ProfileMaker& make_profile, bool is_printed_exit)
      : scene_(scene),
        material_(material),
        is_printed_exit_(is_printed_exit),
        profiles_(scene, conversion, material, make_profile) {}

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override {
    return profiles_.local_reflectance(point);
  }

 private:
  const RenderScene& scene_;
  std::uint32_t material_;
  bool is_printed_exit_;
  MaterialProfiles<N> profiles_;
};

}  // namespace lamina
