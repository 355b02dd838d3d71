// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/profile/bessel.h"

#include <algorithm>
#include <cmath>

namespace lamina::detail {

void bessel_functions(double x, std::span<double> out) {
  const int n = static_cast<int>(out.size()) - 1;
  std::fill(out.begin(), out.end(), 0.0);
  out[0] = 1.0;
  if (x < 1e-9) return;
  const double largest = std::max(x, static_cast<double>(n));
  const int start = 2 * static_cast<int>(0.5 * (largest + 12.0 * std::cbrt(largest)) + 8.0);
  const double two_over_x = 2.0 / x;
  double above = 0.0, here = 1e-280, sum = 0.0;
  for (int m = start; m > 0; --m) {  // here is J_m
    if (m <= n) out[static_cast<std::size_t>(m)] = here;
    if (m % 2 == 0) sum += 2.0 * here;
    const double below = static_cast<double>(m) * two_over_x * here - above;
    above = here;
    here = below;
    if (std::abs(here) < 1e200) continue;
    here *= 1e-250;
    above *= 1e-250;
    sum *= 1e-250;
    for (int q = m; q <= n; ++q) out[static_cast<std::size_t>(q)] *= 1e-250;
  }
  out[0] = here;
  sum += here;
  for (int m = 0; m <= n; ++m) out[static_cast<std::size_t>(m)] /= sum;
}

}  // namespace lamina::detail
