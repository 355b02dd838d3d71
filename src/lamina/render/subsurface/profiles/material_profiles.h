// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/profiles/profile_table.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// The profiles of a material: of slabs of every thickness, for where the object is thin, and of
/// half-spaces of every absorption, where its color is inverted to an albedo.
///
/// Where an object is thin, the profiles are those of a slab of its thickness there, coated on both
/// sides by the layers above the last, and transmission is blended in by the normals.
///
/// Source: [DonnerJensen2005] §3.1 for colors and thin parts; [Hery2003] §2 for inverted ones.
template <int N>
class MaterialProfiles {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the profiles
  MaterialProfiles(const RenderScene& scene, const BandConversion<N>& conversion,
                   std::uint32_t material, const ProfileMaker& make_profile);

  /// Fraction of the flux that entered that leaves again on the lit side.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const;

  /// The profiles at one exit point.
  struct Local {
    const ProfileTable<N>* low = nullptr;
    const ProfileTable<N>* high = nullptr;      ///< a thicker slab
    float blend = 0.0f;                         ///< from low to high
    const ProfileTable<N>* sampling = nullptr;  ///< the one that radii are drawn from
    bool is_inverted = false;
    std::array<std::uint8_t, N> node{};  ///< [band] into by_absorption_, and how far to the next
    Bands node_blend;
    Bands fraction;  ///< of the samples that each band's own profile gets, under inversion
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
  [[nodiscard]] float sample_radius(const Local& local, float u) const;
  [[nodiscard]] float density(const Local& local, float r) const;
  [[nodiscard]] float thickness_at(const SurfacePoint& point) const;
  [[nodiscard]] Vec3f color_at(const SurfacePoint& point) const;
  /// What a color that scales the light that leaves makes of it.
  [[nodiscard]] Bands color_scale(const Vec3f& color) const;

  /// Slabs ever thicker, and last the material as its file says: what Local::low, high point into.
  [[nodiscard]] const std::vector<ProfileTable<N>>& by_thickness() const { return by_thickness_; }
  /// Half-spaces ever darker, if the material's color is inverted: what Local::node points into.
  [[nodiscard]] const std::vector<ProfileTable<N>>& by_absorption() const { return by_absorption_; }
  /// The radius beyond which no profile has any light [mm].
  [[nodiscard]] float support_radius() const { return support_radius_; }
  /// The material itself, however thin the object is.
  [[nodiscard]] const ProfileTable<N>& of_material() const { return by_thickness_.back(); }
  /// Flux per area that leaves per flux that entered at an offset [mm] from the exit [1/mm²].
  [[nodiscard]] Bands evaluate(const Local& local, const Vec3f& offset, const Vec3f& exit_normal,
                               const Vec3f& entry_normal) const;

  /// Where in by_absorption() a reflectance is met: index and fraction of the way to the next.
  [[nodiscard]] Bands albedo_index(const Bands& reflectance) const;

 private:
  void invert_albedo(const Bands& target, Local& local) const;

  const RenderScene& scene_;
  const BandConversion<N>& conversion_;
  const SubsurfaceSurface& surface_;
  std::uint32_t material_;
  float support_radius_ = 0.0f;                 ///< [mm]
  std::vector<ProfileTable<N>> by_thickness_;   ///< the last is the material as its file says
  std::vector<float> thicknesses_;              ///< [mm] of by_thickness_ but the last
  std::vector<ProfileTable<N>> by_absorption_;  ///< less and less reflecting
  int bands_ = 0;
  Vec3f mean_color_{1, 1, 1};
};

}  // namespace lamina
