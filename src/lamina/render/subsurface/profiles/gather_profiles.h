// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/render/subsurface/profiles/gather_table.h"
#include "lamina/render/subsurface/profiles/material_profiles.h"

namespace lamina {

/// The profiles of a material as methods want them that sum over many points of entry: R and T
/// blended by the normals, for the thickness and the color at the exit, in tables over r².
template <int N>
class GatherProfiles {
 public:
  using Bands = BandValues<N>;

  GatherProfiles() = default;
  /// @param blur  see make_gather_tables
  GatherProfiles(const MaterialProfiles<N>& profiles, float blur);

  /// Values of an exit that do not change from one point of entry to the next.
  struct Exit {
    Vec3f normal;  ///< unit length
    const GatherTable<N>* low = nullptr;
    const GatherTable<N>* high = nullptr;  ///< a thicker slab
    float blend = 0.0f;                    ///< from low to high
    bool is_inverted = false;
    Bands albedo_index;  ///< where in the half-spaces of ever darker colors its own is
    Bands scale;         ///< of all light that leaves
  };
  [[nodiscard]] Exit exit_at(const Vec3f& normal, const typename MaterialProfiles<N>::Local& local,
                             const MaterialProfiles<N>& profiles) const;

  /// Flux per area that leaves per flux that entered at a point, `Exit::scale` left out [1/mm²]:
  /// what is reflected and what passes.
  ///
  /// @param offset  of the point of entry, or of the middle of several [mm]
  /// @param r2      squared distance that the reflectance counts with [mm²]
  /// @param normal  there; shorter than 1 where it is a mean
  /// @param albedo_index   as Exit::albedo_index; light is exchanged with the mean of both
  [[nodiscard]] Bands evaluate(const Exit& exit, const Vec3f& offset, float r2, const Vec3f& normal,
                               const Bands& albedo_index) const {
    const Bands reflected = this->reflected(exit, r2, normal, albedo_index);
    return exit.low->is_transmitting ? reflected + passed(exit, offset, normal) : reflected;
  }
  [[nodiscard]] Bands reflected(const Exit& exit, float r2, const Vec3f& normal,
                                const Bands& albedo_index) const;
  [[nodiscard]] Bands passed(const Exit& exit, const Vec3f& offset, const Vec3f& normal) const;

  /// Reflectance of the material itself, however thin the object is [1/mm²].
  [[nodiscard]] const RadialTable<N>& thick_reflectance() const {
    return by_thickness_.back().reflectance;
  }

 private:
  [[nodiscard]] Bands of_color(const Exit& exit, const Bands& reflected, float r2,
                               const Bands& albedo_index) const;

  std::vector<GatherTable<N>> by_thickness_, by_absorption_;
};

template <int N>
BandValues<N> GatherProfiles<N>::reflected(const Exit& exit, float r2, const Vec3f& normal,
                                           const Bands& albedo_index) const {
  const float facing = std::clamp(dot(exit.normal, normal), -1.0f, 1.0f);
  Bands reflected = exit.low->reflectance.at(r2);
  if (exit.blend > 0.0f) reflected += exit.blend * (exit.high->reflectance.at(r2) - reflected);
  if (exit.is_inverted) reflected = of_color(exit, reflected, r2, albedo_index);
  return 0.5f * (1.0f + facing) * reflected;
}

template <int N>
BandValues<N> GatherProfiles<N>::passed(const Exit& exit, const Vec3f& offset,
                                        const Vec3f& normal) const {
  const float facing = std::clamp(dot(exit.normal, normal), -1.0f, 1.0f);
  if (facing >= 1.0f) return {};
  const float along = dot(offset, exit.normal);
  const float lateral2 = std::max(dot(offset, offset) - along * along, 0.0f);
  Bands through = exit.low->transmittance.at(lateral2);
  if (exit.blend > 0.0f) through += exit.blend * (exit.high->transmittance.at(lateral2) - through);
  return 0.5f * (1.0f - facing) * through;
}

}  // namespace lamina
