// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/cell_blurs.h"
#include "lamina/scattering/heterogeneous/gaussian_tables.h"

namespace lamina {

/// Where the far side of a thin part is, seen from a cell.
struct FarSide {
  float thickness = 0.0f;  ///< between the surfaces [mm]; 0: thick
  std::array<std::uint32_t, 4> cell{};
  std::array<float, 4> weight{};  ///< sum to 1
  int count = 0;
};

/// Parts of a surface so thin that light comes through, as ears and nostrils: what has come down to
/// the lower layer at the far side comes up on the near one. The lower layer is a slab there.
///
/// What passes spreads as a Gaussian, or the two next to it, with the second moment of the slab's
/// transmittance profile; totals are the closed form of the multipole. Half of that spread is at
/// the far side and half at the near one, so that light is smooth where neighbours look at places
/// far apart, as at folds.
///
/// Source: [Donner2008] §4.3; [DonnerJensen2005] Eq. 13 and its transform.
template <int N>
struct ThinParts {
  std::vector<FarSide> far;    ///< [cell]; empty: nothing is thin
  CellField<N> spread;         ///< place of the Gaussian among six
  CellField<N> transmittance;  ///< of the lower layer where it is a slab; 0 where it is thick
  CellField<N> reflectance;    ///< of it, over that of a half-space; 1 where it is thick
  std::vector<double> scales;  ///< of half of each, as cell_scales_of_gaussians gives them
};

/// Thin parts of a graph's cells without any band; empty if nothing is thinner than light reaches.
template <int N>
[[nodiscard]] ThinParts<N> make_thin_parts(const CellGraph& graph, std::vector<FarSide> far,
                                           double upper_thickness);

/// Adds a band.
///
/// @param lower            the half-space below, whose absorption differs from cell to cell
/// @param sigma_a          [cell] of it [1/mm]
/// @param upper_thickness  of the layers above it on both sides [mm]
/// @param ior_above        their index
template <int N>
void add_band(int band, const MappedLayer& lower, std::span<const float> sigma_a,
              double upper_thickness, double ior_above, ThinParts<N>& thin);

/// Half of how light spreads on its way through thin parts: what it does at either side.
template <int N>
[[nodiscard]] CellMixture<N> spread_through(const CellGraph& graph, const ThinParts<N>& thin);

/// What comes through from the far sides, to be spread once more.
///
/// @param spread  [cell] light that has come down to the lower layer, spread by spread_through
template <int N>
[[nodiscard]] CellField<N> pass_through(const ThinParts<N>& thin, const CellField<N>& spread);

}  // namespace lamina
