// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/solve/scattering/profile/profile.h"

namespace lamina {

/// Radii of a table, evenly spaced in their logarithm.
struct RadiusGrid {
  float first = 1e-3f, last = 1.0f;  ///< [mm]
  int count = 2;
};

/// A grid that holds `kept` of the light of every band of all profiles, in (0, 1), or ends where
/// the profiles do.
[[nodiscard]] RadiusGrid make_radius_grid(const std::vector<Profile>& profiles,
                                          double kept = 0.998);

/// A profile in the form that rendering wants: all bands of one radius side by side, and a density
/// of radii for all bands, reflection and transmission together.
///
/// The density is the sum of all their profiles. So what a sample weighs, summed over the bands, is
/// the same at every radius, and no band weighs more than that: one set of points serves all bands,
/// with little color grain.
template <int N>
class ProfileTable {
 public:
  /// Light beyond the grid is put back within it, at the cost of placing it too near.
  ///
  /// @param per_entered  factor per band that makes the profile one per flux that entered
  ProfileTable(const Profile& profile, const RadiusGrid& grid, const BandValues<N>& per_entered);

  /// [1/mm²]
  /// @param r  [mm]; beyond the grid the value at its end
  [[nodiscard]] BandValues<N> reflectance_profile(float r) const;
  [[nodiscard]] BandValues<N> transmittance_profile(float r) const;

  [[nodiscard]] const BandValues<N>& total_reflectance() const { return total_reflectance_; }
  [[nodiscard]] const BandValues<N>& total_transmittance() const { return total_transmittance_; }

  /// Radius [mm] for u in [0, 1), and the density of points in the plane that it has [1/mm²].
  [[nodiscard]] float sample_radius(float u) const;
  [[nodiscard]] float density(float r) const { return density_in(ring(r), all_bands); }

  /// Light that a density of radii is for.
  static constexpr int all_bands = -1, passing = -2;  ///< else what a band reflects

  /// The ring in which a radius lies, the same in all tables on one grid; `rings` beyond all.
  [[nodiscard]] std::size_t ring(float r) const;
  [[nodiscard]] std::size_t rings() const { return radii_.size(); }
  /// A radius in a ring, points being even over it, for f in [0, 1].
  [[nodiscard]] float radius_in(std::size_t ring, float f) const;
  /// The density in a ring, and its share of the light within the outer edge of it.
  [[nodiscard]] float density_in(std::size_t ring, int light) const {
    return ring < radii_.size() ? density_of(light).per_area[ring] : 0.0f;
  }
  [[nodiscard]] float share_within(std::size_t ring, int light) const {
    return density_of(light).cumulative[ring];
  }
  /// The light that the density of all bands follows, in total.
  [[nodiscard]] float sampled_light() const {
    return sum(total_reflectance_) + sum(total_transmittance_);
  }

  /// One band of reflectance_profile.
  [[nodiscard]] float reflectance_profile(float r, int band) const;

  [[nodiscard]] float support_radius() const { return radii_.back(); }

 private:
  /// A density of radii, even within each cell: cell 0 is the disc within the first radius, cell i
  /// the ring up to radius i.
  struct Density {
    std::vector<float> per_area;    ///< [cell] [1/mm²]
    std::vector<float> cumulative;  ///< [cell], ends at 1
  };
  [[nodiscard]] Density make_density(const std::vector<double>& mass) const;
  [[nodiscard]] const Density& density_of(int light) const {
    return light == all_bands ? all_
           : light == passing ? passing_
                              : of_band_[static_cast<std::size_t>(light)];
  }
  [[nodiscard]] float place(float r) const;

  float log2_first_ = 0.0f, nodes_per_octave_ = 1.0f;
  std::vector<float> radii_;
  std::vector<BandValues<N>> reflectance_, transmittance_;  ///< [radius] [1/mm²]
  BandValues<N> total_reflectance_, total_transmittance_;
  Density all_, passing_;
  std::vector<Density> of_band_;  ///< [band], of reflectance
};

}  // namespace lamina
