// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_heights.h"

#include <algorithm>
#include <cmath>

#include "lamina/base/core/quadrature.h"

namespace lamina::detail {
namespace {

/// Heights as Gauss nodes in u, and the Lagrange polynomials there by their coefficients.
struct Heights {
  std::array<double, heights> u;
  std::array<std::array<double, heights>, heights> coefficient;  ///< [height][power]
};

const Heights& height_nodes() {
  static const Heights made = [] {
    Heights h{};
    const Quadrature rule = gauss_legendre(static_cast<int>(heights), 0.0, 1.0);
    for (std::size_t l = 0; l < heights; ++l) h.u[l] = rule.nodes[l];
    for (std::size_t l = 0; l < heights; ++l) {
      auto& c = h.coefficient[l];
      c[0] = 1.0;
      for (std::size_t k = 0, degree = 0; k < heights; ++k) {
        if (k == l) continue;
        const double scale = 1.0 / (h.u[l] - h.u[k]);
        ++degree;
        for (std::size_t power = degree + 1; power-- > 0;)
          c[power] = scale * ((power > 0 ? c[power - 1] : 0.0) - h.u[k] * c[power]);
      }
    }
    return h;
  }();
  return made;
}

}  // namespace

const HeightShares& facet_heights() { return height_nodes().u; }

HeightShares next_heights(double u, double lambda, bool is_rising) {
  const double log_u = std::log(u);
  HeightShares moment;  // mean of u'^k over the light that meets one
  for (std::size_t k = 0; k < heights; ++k) {
    const auto power = static_cast<double>(k);
    if (!is_rising) {
      moment[k] = std::pow(u, power) * (1.0 + lambda) / (1.0 + lambda + power);
      continue;
    }
    // lambda (u^lambda - u^power) / (power - lambda), from the larger of the two powers
    const double y = std::abs((power - lambda) * log_u);
    moment[k] = -lambda * log_u * std::pow(u, std::min(lambda, power)) *
                (y == 0.0 ? 1.0 : -std::expm1(-y) / y);
  }
  HeightShares shares{};
  for (std::size_t l = 0; l < heights; ++l)
    for (std::size_t k = 0; k < heights; ++k)
      shares[l] += height_nodes().coefficient[l][k] * moment[k];
  return shares;
}

}  // namespace lamina::detail
