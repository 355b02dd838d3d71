// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace lamina {

/// Misfit of many fits to one band, beside what errors of the stated size would leave.
struct BandMisfit {
  double squares = 0.0;  ///< sum of squared residuals, in stated standard deviations
  /// Sum of 1 less the leverage of each residual: what its square is on average, over the square of
  /// its standard deviation, where what is known before is right
  double left = 0.0;
  double count = 0.0;  ///< of residuals
};

/// Adds what others leave of the same bands; either may be empty.
void add_misfit(std::vector<BandMisfit>& sum, std::span<const BandMisfit> more);

/// Reduced chi squared of each band: by how much the variances of its residuals are larger than
/// stated. Where numbers follow a band nearly everywhere its residual says little: so a tenth of
/// each counts as what all bands have together, and a tenth of these as what is stated.
///
/// Source: the almost unbiased estimate of [HornHornDuncan1975], of the residuals of a band
/// together.
[[nodiscard]] std::vector<double> chi_squared_of(std::span<const BandMisfit> bands);

/// Factors by which errors are to grow, the root of chi squared where that is above 1: the largest
/// errors are then as large as what is left.
[[nodiscard]] std::vector<double> error_growth_of(std::span<const BandMisfit> bands);

/// How much some factors exceed others, at the most; of none 1.
[[nodiscard]] double largest_ratio(std::span<const double> factors, std::span<const double> others);

/// Chi squared beyond which a note says so.
inline constexpr double chi_squared_of_note = 2.0;

}  // namespace lamina
