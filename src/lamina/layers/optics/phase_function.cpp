// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/phase_function.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr double inv_4pi = 0.25 * std::numbers::inv_pi;

double evaluate_one(const HenyeyGreenstein& phase, double cos_theta) {
  const double g = phase.g;
  // 1 + g^2 - 2 g cos, without cancellation where the peak is sharp.
  const double d = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta);
  return inv_4pi * (1.0 - g * g) / (d * std::sqrt(d));
}

double evaluate_one(const Rayleigh&, double cos_theta) {
  return 0.75 * inv_4pi * (1.0 + cos_theta * cos_theta);
}

double moment_one(const HenyeyGreenstein& phase, int l) { return std::pow(phase.g, l); }

double moment_one(const Rayleigh&, int l) { return l == 0 ? 1.0 : l == 2 ? 0.1 : 0.0; }

/// Source: [HanrahanKrueger1993] Figure 7, line 2B, in the form of [Witt1977] that keeps its digits
/// as g tends to 0.
double sample_one(const HenyeyGreenstein& phase, double u) {
  const double g = phase.g;
  const double x = 1.0 - 2.0 * u;  // isotropic: cos_theta = -x
  if (std::abs(g) < 1e-4) return std::clamp(-x + 1.5 * g * (1.0 - x * x), -1.0, 1.0);
  const double q = (1.0 - g * g) / (1.0 - g * x);
  return std::clamp((1.0 + g * g - q * q) / (2.0 * g), -1.0, 1.0);
}

/// Inverts u = (4 + 3 c + c^3) / 8 by Cardano's formula.
double sample_one(const Rayleigh&, double u) {
  const double q = 4.0 * u - 2.0;
  const double root = std::cbrt(q + std::sqrt(q * q + 1.0));
  return std::clamp(root - 1.0 / root, -1.0, 1.0);
}

/// Mean of what `of` says of the lobes of a mixture, by their weights.
template <typename Function>
double mean_of_lobes(const PhaseMixture& mixture, const Function& of) {
  double sum = 0.0;
  for (const auto& lobe : mixture.lobes) sum += lobe.weight * std::visit(of, lobe.phase);
  return sum;
}

double evaluate_one(const PhaseMixture& mixture, double cos_theta) {
  return mean_of_lobes(mixture, [&](const auto& one) { return evaluate_one(one, cos_theta); });
}

double moment_one(const PhaseMixture& mixture, int l) {
  return mean_of_lobes(mixture, [&](const auto& one) { return moment_one(one, l); });
}

template <typename Kind>
double sample_kind(const Kind& kind, double u1, double /*u2*/) {
  return sample_one(kind, u1);
}

double sample_kind(const PhaseMixture& mixture, double u1, double u2) {
  const auto of = [&](const auto& one) { return sample_one(one, u1); };
  for (const auto& lobe : mixture.lobes) {
    if (u2 < lobe.weight) return std::visit(of, lobe.phase);
    u2 -= lobe.weight;
  }
  return std::visit(of, mixture.lobes.back().phase);
}

}  // namespace

double evaluate(const PhaseFunction& phase, double cos_theta) {
  assert(-1.0 <= cos_theta && cos_theta <= 1.0);
  return std::visit([&](const auto& kind) { return evaluate_one(kind, cos_theta); }, phase);
}

double mean_cosine(const PhaseFunction& phase) { return legendre_moment(phase, 1); }

double legendre_moment(const PhaseFunction& phase, int l) {
  assert(l >= 0);
  return std::visit([&](const auto& kind) { return moment_one(kind, l); }, phase);
}

double sample_cos_theta(const PhaseFunction& phase, double u1, double u2) {
  return std::visit([&](const auto& kind) { return sample_kind(kind, u1, u2); }, phase);
}

}  // namespace lamina
