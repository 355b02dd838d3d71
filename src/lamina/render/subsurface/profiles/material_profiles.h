// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/profiles/profile_table.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// Subsurface transport by the profile of a flat layered slab, laid over the real surface.
///
/// From the point where light leaves, probe rays are sent through the object at radii drawn from
/// the profile, along the normal and now and then a tangent; one of their hits is where the light
/// entered. All points within reach of the profile can be found along at least one axis, and a
/// point counts with the density of all three.
///
/// Holds for surfaces that are flat over a mean free path and for objects without holes inside.
/// Where the object is thin, the profiles are those of a slab of its thickness there, coated on
/// both sides by the layers above the last, and transmission is blended in by the normals.
///
/// Source: [DonnerJensen2005] Eqs. 25, 27; the three axes [King2013]. Departures: there the axes
/// are combined by the balance heuristic, which on a gently curved surface lets grazing probes
/// along the tangents spoil the even samples of the normal; here the axes share the points out. The
/// normal that probes start from is the smooth one, since a bump map's would throw them off; of
/// several hits one is drawn by its weight.
template <int N>
class ProfileTransport final : public SubsurfaceMethod<N> {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the transport
  ProfileTransport(const RenderScene& scene, const BandConversion<N>& conversion,
                   std::uint32_t material, const ProfileMaker& make_profile, bool is_printed_exit);

  [[nodiscard]] Bands leaving_radiance(const ExitPoint& exit, const LightGatherer<N>& light,
                                       PixelSamples& samples) const override;
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const override;

  /// The profiles at one exit point.
  struct Local {
    const SpreadTable<N>* low = nullptr;
    const SpreadTable<N>* high = nullptr;      ///< a thicker slab
    float blend = 0.0f;                        ///< from low to high
    const SpreadTable<N>* sampling = nullptr;  ///< the one that radii are drawn from
    bool is_inverted = false;
    std::array<std::uint8_t, N> node{};  ///< [band] into by_absorption_, and how far to the next
    Bands node_blend;
    Bands share;  ///< of the samples that each band's own profile gets, under inversion
    Bands scale = Bands::filled(1.0f);
  };
  [[nodiscard]] Local profiles_at(const SurfacePoint& point) const {
    return profiles_for(thickness_at(point), color_at(point));
  }
  /// @param thickness  of the object there [mm]
  /// @param color      of the material there
  [[nodiscard]] Local profiles_for(float thickness, const Vec3f& color) const;
  /// A radius from the profiles of both sides, and the density of points in the plane that it has
  /// [mm], [1/mm²].
  [[nodiscard]] float draw_radius(const Local& local, float u) const;
  [[nodiscard]] float density(const Local& local, float r) const;
  [[nodiscard]] float thickness_at(const SurfacePoint& point) const;
  [[nodiscard]] Vec3f color_at(const SurfacePoint& point) const;
  /// What a colour that scales the light that leaves makes of it.
  [[nodiscard]] Bands color_scale(const Vec3f& color) const;

  /// Radiance towards the eye per flux per area that leaves [1/sr].
  [[nodiscard]] float leaving_share(const ExitPoint& exit) const;

  /// Slabs ever thicker, and last the material as its file says: what Local::low, high point into.
  [[nodiscard]] const std::vector<SpreadTable<N>>& by_thickness() const { return by_thickness_; }
  /// Half-spaces ever darker, if the material's colour is inverted: what Local::node points into.
  [[nodiscard]] const std::vector<SpreadTable<N>>& by_absorption() const { return by_absorption_; }
  /// Where in by_absorption() a reflectance is met: index and fraction of the way to the next.
  [[nodiscard]] Bands shade_of(const Bands& reflectance) const;

 private:
  void invert_albedo(const Bands& target, Local& local) const;
  [[nodiscard]] Bands spread(const Local& local, const Vec3f& offset, const Vec3f& exit_normal,
                             const Vec3f& entry_normal) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  bool is_printed_exit_;
  float reach_ = 0.0f;                         ///< of all profiles [mm]
  std::vector<SpreadTable<N>> by_thickness_;   ///< the last is the material as its file says
  std::vector<float> thicknesses_;             ///< [mm] of by_thickness_ but the last
  std::vector<SpreadTable<N>> by_absorption_;  ///< less and less reflecting
  int bands_ = 0;
  Vec3f mean_color_{1, 1, 1};
};

}  // namespace lamina
