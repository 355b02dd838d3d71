// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/core/chebyshev_table.h"
#include "lamina/base/core/progress.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// The leaves that a table covers. Each number lies between those of `low` and `high`; what both
/// have alike is fixed.
struct LeafRange {
  LeafParameters low, high;
};

/// How much light leaves of any pigments reflect and transmit at given wavelengths, by radiative
/// transfer, in microseconds: for fits of spectra.
///
/// By the recipe leaves are alike in three numbers: absorption of the whole leaf, the palisade's
/// share of it, and the structure. The table holds totals by adding-doubling at Chebyshev points of
/// these and interpolates logarithms. Its error is below 1e-3 of the totals over the range of
/// leaf_fit_range (tests), and below 3e-6 of the light where less than 3e-3 of it comes out; making
/// it takes .1 CPU-s, with shares that are not fixed .8.
class LeafTotalsTable {
 public:
  /// @param wavelengths  [nm], those of the recipe
  /// @throws InvalidInput for a wavelength or parameter out of its range, or `low` above `high`;
  ///         Interrupted if progress asks to stop.
  LeafTotalsTable(const std::vector<double>& wavelengths, Incidence incidence,
                  const LeafRange& range, const Progress& progress = {});

  /// Fractions of the incident light, reflected without what the surface mirrors.
  struct Totals {
    double reflectance = 0.0, transmittance = 0.0;
  };

  /// At one of the wavelengths. What lies out of the range counts as its nearest place.
  [[nodiscard]] Totals totals(const LeafParameters& leaf, std::size_t wavelength) const;

  /// Totals with their derivatives by numbers of the leaf, [number].
  [[nodiscard]] Totals totals(const LeafParameters& leaf, std::size_t wavelength,
                              std::span<double LeafParameters::*const> numbers,
                              std::span<Totals> derivatives) const;

  /// Specular reflectance of the surface, the same at all wavelengths.
  [[nodiscard]] double specular_reflectance() const { return specular_; }

 private:
  using Place = ChebyshevTable::Point;  ///< absorption, the palisade's share, structure
  [[nodiscard]] Place place(const LeafParameters& leaf, std::size_t wavelength) const;

  std::vector<LeafSpectrum> spectra_;  ///< [wavelength]
  ChebyshevTable reflectance_, transmittance_;
  double specular_ = 0.0;
};

/// The range in which spectra of leaves are fitted: any pigments that leaves have; structure .3 to
/// 10; all else as in `leaf`.
[[nodiscard]] LeafRange leaf_fit_range(const LeafParameters& leaf);

}  // namespace lamina
