// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/thin_parts/thin_parts.h"

namespace lamina::detail {

/// Response of the last layer of a stack to even light where it is a slab between two coats.
struct SlabResponse {
  double transmittance;
  double reflectance;  ///< over that of a half-space
};

/// The last layer of a stack, and what boundaries like its upper one turn back from inside.
struct SlabLayer {
  MappedLayer layer;
  double inside;
};
[[nodiscard]] SlabLayer last_layer(const MappedStack& stack);

/// A slab of it by the multipole.
/// @param sigma_a    of the layer [1/mm]
/// @param thickness  of it [mm], > 0
[[nodiscard]] SlabResponse multipole_slab(const SlabLayer& layer, double sigma_a, double thickness);

/// Slabs of thicknesses at equal ratios.
inline constexpr std::size_t slab_count = 32;
[[nodiscard]] double slab_thickness(std::size_t index);  ///< [mm]

/// Factors on what the multipole says of slabs, with which a slab and a coat on either side of it
/// transmit and reflect as radiative transfer has it; 1 for totals of diffusion.
struct SlabFactors {
  std::vector<SlabResponse> slabs;  ///< [slab]
  /// [slab], share of what it transmits that has been scattered: the rest goes on in a straight
  /// line, and is no light that leaves in all directions
  std::vector<double> scattered;
  double half_space = 1.0;  ///< on its reflectance
};
[[nodiscard]] SlabFactors transfer_factors(const ThinBand& band);

/// A value between slabs, linear over the logarithm of thickness.
[[nodiscard]] SlabResponse between_slabs(std::span<const SlabResponse> slabs, double thickness);

enum class SlabLight { all, scattered };

/// Transmittance profiles of slabs of any thickness, and the reflectance profile of the half-space,
/// in all bands.
///
/// Between faces that are not parallel a slab says too much where it is thin: in a slab light comes
/// nearer to the far face before it first scatters, or goes straight through, but along it at an
/// edge. There a slab of (d⁴ + (1.75 l)⁴)^(1/4) takes the place of one of thickness d, with l the
/// reduced mean free path: what image sources at depths of an exponential say of all light that
/// comes from one face to a place on the other, within 30 % (test).
template <int N>
class SlabProfiles {
 public:
  SlabProfiles() = default;
  /// @param factors  [band]
  /// @param blur     standard deviation of a Gaussian that profiles are convolved with [mm]
  SlabProfiles(std::span<const ThinBand> bands, const std::vector<SlabFactors>& factors,
               double blur, SlabLight light);

  /// Flux per area that leaves per flux that arrived at a point [1/mm²].
  /// @param thickness  of the slab [mm]
  /// @param lateral2   squared distance along it [mm²]
  /// @param opening    squared cosine of half the angle between the normals of its faces: 0 if they
  ///                   are parallel, 1/2 at an edge of 90°
  [[nodiscard]] BandValues<N> transmittance(float thickness, float lateral2, float opening) const;
  /// Reflectance of a half-space at a distance.
  [[nodiscard]] BandValues<N> reflectance(float distance2) const;

 private:
  [[nodiscard]] BandValues<N> looked_up(std::size_t first_row, float slab, float distance) const;

  /// [slab][distance]; behind them the half-space, then the slabs between faces of an edge of 90°
  std::vector<BandValues<N>> values_;
  float longest_ = 0.0f;  ///< mean free path [mm]
};

}  // namespace lamina::detail
