// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/base/core/quadrature.h"

namespace lamina::reference {

/// Chandrasekhar's function for isotropic scattering, by iterating its integral equation.
/// Source: [Chandrasekhar1960] §38: 1 / H(x) = sqrt(1 - W) + W/2 integral of y H(y) / (x + y).
[[nodiscard]] inline double h_function(double albedo, double x) {
  const Quadrature rule = gauss_legendre(60, 0.0, 1.0);
  std::vector<double> h(60, 1.0);
  const auto inverse_h = [&](double at) {
    double value = std::sqrt(1.0 - albedo);
    for (std::size_t i = 0; i < 60; ++i)
      value += 0.5 * albedo * rule.weights[i] * rule.nodes[i] * h[i] / (at + rule.nodes[i]);
    return value;
  };
  for (int pass = 0; pass < 300; ++pass) {
    std::vector<double> next;
    for (const double node : rule.nodes) next.push_back(1.0 / inverse_h(node));
    h = next;
  }
  return 1.0 / inverse_h(x);
}

}  // namespace lamina::reference
