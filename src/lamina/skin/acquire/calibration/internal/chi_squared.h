// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// The value below which a share of chi-squared numbers lies, over their degrees of freedom: within
/// 2 % from 3 degrees on, 1 % from 10 on, for shares in [.1, .99].
/// @param normal  the value below which that share of normal numbers lies
/// Source: [WilsonHilferty1931].
[[nodiscard]] inline double chi_squared_quantile(double degrees, double normal) {
  const double spread = 2.0 / (9.0 * degrees);
  return std::pow(1.0 - spread + normal * std::sqrt(spread), 3);
}

}  // namespace lamina
