// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace lamina {

/// A number that was measured by random sampling.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;  ///< of the value, one standard deviation
};

/// The mean of n samples from their sum and the sum of their squares.
///
/// Its standard error is that of n + 2 samples: of those taken, of a 0, and of one more like those
/// that are not 0, which weigh squares / sum on average. So what was never seen, or always, is not
/// held for certain after few samples: 0 of n is 0 ± largest / n, and one 1 is 1 ± 0.33. Where k
/// samples are not 0 the error exceeds that of the common formula by a factor of about 1 + 1 / 2k.
///
/// @param largest  what a sample weighs at most, > 0.
///
/// Source: Laplace's rule of succession; [AgrestiCoull1998] adds two samples of either kind.
[[nodiscard]] inline Estimate sample_mean(double n, double sum, double squares,
                                          double largest = 1.0) {
  if (!(n > 0.0)) return {0.0, largest};
  squares = std::max(squares, sum * sum / n);  // whatever rounding does
  const double one_more = sum != 0.0 ? std::min(squares / std::abs(sum), largest) : largest;
  const double mean = (sum + one_more) / (n + 2.0);
  const double mean_square = (squares + one_more * one_more) / (n + 2.0);
  return {sum / n, std::sqrt(std::max(0.0, mean_square - mean * mean) / (n + 1.0))};
}

}  // namespace lamina
