// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "lamina/render/shading/band_conversion.h"
#include "lamina/render/shading/render_scene.h"
#include "lamina/render/subsurface/profiles/absorption_series.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/render/subsurface/profiles/profile_table.h"
#include "lamina/render/subsurface/profiles/radius_mixture.h"
#include "lamina/render/subsurface/subsurface_method.h"

namespace lamina {

/// The profiles of a material: of slabs of every thickness, for where the object is thin, and of
/// half-spaces of every absorption, where its color is inverted to an albedo.
///
/// Where an object is thin, the profiles are those of a slab of its thickness there, coated on both
/// sides by the layers above the last, and transmission is blended in by the normals.
///
/// A color that scales does so where light enters, so that the profile spreads color and light
/// together: in even light that is the texture convolved with the profile and normalized to a mean
/// of white, which scales what leaves. Of what enters at a point no more leaves than entered.
///
/// A color that is inverted sets the absorption at both ends: the profile between two points is
/// that halfway between their places among the half-spaces, so that transport is reciprocal.
///
/// Source: [DonnerJensen2005] §3.1 for colors and thin parts, where the convolved texture scales
/// the light that leaves; [Hery2003] §2 for inverted ones.
template <int N>
class MaterialProfiles {
 public:
  using Bands = BandValues<N>;

  /// @param material  index of a translucent material; the scene must outlive the profiles
  MaterialProfiles(const RenderScene& scene, const BandConversion<N>& conversion,
                   std::uint32_t material, const ProfileMaker& make_profile);

  /// Fraction of the flux that entered that leaves again on the lit side.
  [[nodiscard]] Bands local_reflectance(const SurfacePoint& point) const;

  /// Two slabs between which a thickness lies.
  struct Slabs {
    const ProfileTable<N>* low = nullptr;
    const ProfileTable<N>* high = nullptr;  ///< the thicker one
    float blend = 0.0f;                     ///< from low to high
  };
  /// The profiles at one exit point.
  struct Local : Slabs {
    bool is_inverted = false;
    Bands albedo_index;  ///< [band] place in by_absorption(): node, and how far to the next
    Bands scale = Bands::filled(1.0f);
  };
  [[nodiscard]] Local profiles_at(const SurfacePoint& point) const {
    return profiles_for(thickness_at(point), color_at(point));
  }
  /// @param thickness  of the object there [mm]
  /// @param color      of the material there
  [[nodiscard]] Local profiles_for(float thickness, const Vec3f& color) const;

  /// Density that radii around an exit point are drawn from: the profiles of both sides, by their
  /// light. Where a map makes other places brighter, and profiles between wider than that of the
  /// exit, a quarter of the samples is for the widest there can be.
  [[nodiscard]] RadiusMixture<N> radius_mixture(const Local& local) const;

  [[nodiscard]] float thickness_at(const SurfacePoint& point) const;
  [[nodiscard]] Vec3f color_at(const SurfacePoint& point) const;

  /// Factor of a color that scales on the light that enters: the color over the mean of its map,
  /// but not so much that more would leave than entered. 1 for other colors.
  [[nodiscard]] Bands entering_color(float thickness, const Vec3f& color) const;
  [[nodiscard]] Bands entering_color(const SurfacePoint& point) const;
  [[nodiscard]] bool scales_color() const {
    return surface_.color_use == SubsurfaceSurface::ColorUse::scale;
  }

  /// Where in by_absorption() a color is met; 0 where colors are not inverted.
  [[nodiscard]] Bands albedo_index(const Vec3f& color) const;

  /// The factor on the absorption of each band with which the layers reflect a color, see
  /// with_absorption; 1 where colors are not inverted.
  [[nodiscard]] Bands absorption_factor(const Vec3f& color) const;
  /// All that leaves of light that entered, on both sides, of an object of a thickness [mm] without
  /// a color.
  [[nodiscard]] Bands total_leaving(float thickness) const;

  /// Slabs ever thicker, and last the material as its file says: what Local::low, high point into.
  [[nodiscard]] const std::vector<ProfileTable<N>>& by_thickness() const { return by_thickness_; }
  /// Half-spaces ever darker, if the material's color is inverted.
  [[nodiscard]] const std::vector<ProfileTable<N>>& by_absorption() const { return by_absorption_; }
  /// The radius beyond which no profile has any light [mm].
  [[nodiscard]] float support_radius() const { return support_radius_; }
  /// The material itself, however thin the object is.
  [[nodiscard]] const ProfileTable<N>& of_material() const { return by_thickness_.back(); }
  /// Flux per area that leaves per flux that entered at an offset [mm] from the exit [1/mm²].
  ///
  /// @param entry_index  albedo_index of the color where it entered
  [[nodiscard]] Bands evaluate(const Local& local, const Vec3f& offset, const Vec3f& exit_normal,
                               const Vec3f& entry_normal, const Bands& entry_index) const;

 private:
  [[nodiscard]] Slabs slabs_of(float thickness) const;
  /// Distance along the inward normal to where a ray leaves the object [mm], infinite beyond `reach`;
  /// what is nearer than `nearest` does not count.
  [[nodiscard]] float distance_to_far_side(const Vec3f& position, const Vec3f& normal,
                                           float nearest, float reach) const;
  /// The least thickness of places all over the objects, or of the map that gives it [mm]; infinite
  /// where there is no far side.
  [[nodiscard]] float thinnest_place(float nearest, float reach) const;
  [[nodiscard]] Bands color_over_mean(const Vec3f& color) const;
  /// The most that a color may scale by.
  [[nodiscard]] Bands largest_scale(float thickness) const;
  [[nodiscard]] std::optional<AbsorptionSeries> make_series(const std::vector<LayerStack>& layers,
                                                            const ProfileMaker& make_profile) const;
  /// The half-spaces that meet a reflectance, and how far from one to the other.
  struct Between {
    std::size_t node = 0;
    float blend = 0.0f;
  };
  [[nodiscard]] Between find_reflectance(float reflectance, int band) const;
  [[nodiscard]] Between between(float index) const {
    const std::size_t node = std::min(static_cast<std::size_t>(index), by_absorption_.size() - 2);
    return {node, index - static_cast<float>(node)};
  }

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
  Bands brightest_index_;  ///< of all colors of the map
  Bands once_;             ///< of even light, leaves after one event; 0 unless that is added
  std::optional<AbsorptionSeries> series_;
};

}  // namespace lamina
