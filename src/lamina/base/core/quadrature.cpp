// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/core/quadrature.h"

#include <cassert>
#include <numbers>

namespace lamina {

Quadrature gauss_legendre(int n, double a, double b) {
  assert(n >= 1);
  const auto size = static_cast<std::size_t>(n);
  Quadrature rule{std::vector<double>(size), std::vector<double>(size)};
  const double center = 0.5 * (a + b), half = 0.5 * (b - a);
  for (int i = 0; i < (n + 1) / 2; ++i) {
    // Tricomi's estimate of the root, then Newton on P_n by its three-term recurrence.
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 100; ++step) {
      double p = 1.0, p_before = 0.0;
      for (int l = 0; l < n; ++l) {
        const double p_next = ((2.0 * l + 1.0) * x * p - l * p_before) / (l + 1.0);
        p_before = p;
        p = p_next;
      }
      slope = n * (x * p - p_before) / (x * x - 1.0);
      const double dx = p / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    if (n % 2 == 1 && i == n / 2) x = 0.0;
    const double weight = 2.0 / ((1.0 - x * x) * slope * slope);
    const auto low = static_cast<std::size_t>(i), high = size - 1 - low;
    rule.nodes[low] = center - half * x;
    rule.nodes[high] = center + half * x;
    rule.weights[low] = rule.weights[high] = weight * half;
  }
  return rule;
}

}  // namespace lamina
