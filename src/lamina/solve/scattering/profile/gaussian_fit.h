// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// A radial profile as a sum of Gaussians of unit flux,
///
///     profile(r) = sum of weights[i] exp(-r^2 / (2 v[i])) / (2 pi v[i]),
///
/// with variances v [mm²] that several profiles may share. A variance of 0 is light that leaves
/// where it entered.
struct GaussianSum {
  std::vector<double> variances;  ///< [mm²], ascending, >= 0
  std::vector<double> weights;    ///< flux of each Gaussian, >= 0
};

/// Value at distance r [mm], Gaussians of variance 0 left out [1/mm²].
[[nodiscard]] double evaluate(const GaussianSum& sum, double r);

/// The transform at spatial frequency k [1/mm]: sum of weights[i] exp(-v[i] k^2 / 2).
[[nodiscard]] double evaluate_at_frequency(const GaussianSum& sum, double k);

/// 0 and then `count` variances, each twice the last. [Donner2008] §5 has 18 from 1e-4 mm² on; the
/// 0 serves where mean free paths are shorter than a hundredth of a millimetre.
[[nodiscard]] std::vector<double> doubling_variances(double first = 1e-4, int count = 18);

/// A fit and how far it is off.
struct GaussianFit {
  GaussianSum sum;
  double rms_error;      ///< over the frequencies, relative to the spectrum at k = 0
  double largest_error;  ///< the same, the largest
  int iterations;
  bool converged;  ///< false if the steps ran out; the weights are then valid but not the best
};

/// Fits weights >= 0 by least squares over spatial frequency, where Gaussians are Gaussians and
/// nothing need be sampled in r.
///
/// @param spectrum   a profile's transform at `k`, of the same size.
/// @param k          frequencies [1/mm], >= 0; a geometric series weighs all scales alike.
/// @param variances  [mm²], >= 0, at least one.
///
/// Spectra of reflected and transmitted light fall ever flatter than Gaussians, so that positive
/// weights suit them: 19 doubling variances leave at most 1 % of the value at k = 0 for skin. What
/// a layer transmits that is about as thin as its mean free path may need negative weights; the
/// error tells.
///
/// Source: [LawsonHanson1974] ch. 23, non-negative least squares; the free ones by QR.
[[nodiscard]] GaussianFit fit_gaussians(std::span<const double> spectrum, std::span<const double> k,
                                        std::span<const double> variances);

/// Frequencies at which the widest of `variances` has not yet begun to fall to where the narrowest
/// above 0 has vanished, in a geometric series, and 0 [1/mm].
[[nodiscard]] std::vector<double> fit_frequencies(std::span<const double> variances,
                                                  std::size_t count = 200);

}  // namespace lamina
