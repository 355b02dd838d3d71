// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/thin_parts.h"

namespace lamina::detail {

/// What the last layer of a stack does with even light where it is a slab between two coats.
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
  double half_space = 1.0;          ///< on its reflectance
};
[[nodiscard]] SlabFactors transfer_factors(const ThinBand& band);

/// A value between slabs, linear over the logarithm of thickness.
[[nodiscard]] SlabResponse between_slabs(std::span<const SlabResponse> slabs, double thickness);

/// Transmittance profiles of slabs of any thickness, and the reflectance profile of the half-space,
/// in all bands.
template <int N>
class SlabProfiles {
 public:
  SlabProfiles() = default;
  /// @param factors  [band]
  /// @param blur     standard deviation of a Gaussian that profiles are convolved with [mm]
  SlabProfiles(std::span<const ThinBand> bands, const std::vector<SlabFactors>& factors,
               double blur);

  /// Flux per area that leaves per flux that arrived at a point [1/mm²].
  /// @param thickness  of the slab [mm]
  /// @param lateral2   squared distance along it [mm²]
  [[nodiscard]] BandValues<N> transmittance(float thickness, float lateral2) const;
  /// The same of light that a half-space reflects at a distance.
  [[nodiscard]] BandValues<N> reflectance(float distance2) const;

 private:
  std::vector<BandValues<N>> values_;  ///< [slab][distance], and behind them the half-space
};

}  // namespace lamina::detail
