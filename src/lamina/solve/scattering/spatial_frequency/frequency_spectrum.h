// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {

/// Spatial frequencies at which a smooth, even function of k is asked for: the positive half of a
/// Chebyshev grid in u = asinh(k / scale), and the law by which it goes on beyond.
struct FrequencyGrid {
  double scale = 1.0;     ///< half the slowest lateral decay rate [1/mm]
  double highest = 1.0;   ///< [1/mm]
  std::vector<double> k;  ///< [1/mm], descending, all > 0
};

/// @param highest_per_sigma_t  of the densest layer
[[nodiscard]] FrequencyGrid make_frequency_grid(const GridStack& stack, int count,
                                                double highest_per_sigma_t = 4.0);

/// How far a beam's response is to be known: beyond, light scattered twice or more is smooth and
/// small against the rest, for waves shorter than the mean free path and than what scatters is
/// thick.
[[nodiscard]] double beam_frequencies_per_sigma_t(const GridStack& stack);

/// A function of k through its values on such a grid: an even Chebyshev series for (1 + (k/k0)^2)
/// F, handed over smoothly to (a + b ln k + c / k) / k^2, which is how light scattered twice falls.
struct Spectrum {
  FrequencyGrid grid;
  std::vector<double> series;  ///< even Chebyshev coefficients
  double a = 0.0, b = 0.0, c = 0.0;
};
[[nodiscard]] Spectrum make_spectrum(const FrequencyGrid& grid, std::span<const double> values);

/// The spectrum that fewer frequencies would have found, the function being as it is.
[[nodiscard]] Spectrum resampled(const Spectrum& spectrum, int count);

/// Spectrum as it would be if the grid had ended at this fraction of its highest frequency. The
/// law of the tail then begins earlier: where it does not hold yet, the two differ as much as the
/// tail is wrong, and the profile rings.
[[nodiscard]] Spectrum ended_at(const Spectrum& spectrum, double share);

/// The function at k >= 0 [1/mm].
[[nodiscard]] double evaluate(const Spectrum& spectrum, double k);

}  // namespace lamina::detail
