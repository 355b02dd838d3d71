// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/fresnel.h"

namespace lamina {
namespace {

/// (y coth y - 1) / sinh y for y >= 0. The series serves where the difference loses its digits;
/// its first term left out is below 1e-15 of the sum.
double coth_term(double y) {
  if (y < 0.25) {
    const double q = y * y;
    const double series =
        1.0 / 3 +
        q * (-1.0 / 45 +
             q * (2.0 / 945 + q * (-1.0 / 4725 + q * (2.0 / 93555 + q * (-1382.0 / 638512875 +
                                                                         q * 4.0 / 18243225)))));
    return y == 0.0 ? 0.0 : q * series / std::sinh(y);
  }
  return (y / std::tanh(y) - 1.0) / std::sinh(y);
}

/// For light that enters the denser medium, n >= 1. Duntley's closed form has terms that cancel
/// as n tends to 1. With n = exp(y / 2) its last two terms, which do so, join to `coth_term`.
double fresnel_diffuse_from_outside(double n) {
  if (n == 1.0) return 0.0;
  const double a = n * n + 1.0, b = (n - 1.0) * (n + 1.0);
  return 0.5 - 2.0 * n * n * n / (a * a) +
         (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0)) +
         n * n * b * b / (a * a * a) * std::log((n - 1.0) / (n + 1.0)) +
         2.0 * n * n / a * coth_term(2.0 * std::log(n));
}

}  // namespace

double fresnel_diffuse(double eta) {
  assert(eta > 0.0);
  if (eta >= 1.0) return fresnel_diffuse_from_outside(eta);
  return 1.0 - eta * eta * (1.0 - fresnel_diffuse_from_outside(1.0 / eta));
}

double fresnel_diffuse_polynomial(double eta) {
  assert(eta > 0.0);
  const double n = 1.0 / eta;  // the papers' ratio, index of the medium that holds the light on top
  if (n >= 1.0) return -1.4399 / (n * n) + 0.7099 / n + 0.6681 + 0.0636 * n;
  return -0.4399 + 0.7099 / n - 0.3319 / (n * n) + 0.0636 / (n * n * n);
}

}  // namespace lamina
