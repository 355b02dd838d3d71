// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/optics/phase_function_derivative.h"

#include <cassert>
#include <cmath>

namespace lamina {
namespace {

double moment_by_g(const HenyeyGreenstein& phase, int l) {
  return l == 0 ? 0.0 : l * std::pow(phase.g, l - 1);
}

double moment_by_g(const Rayleigh& /*phase*/, int /*l*/) { return 0.0; }

double moment_by_g(const PhaseMixture& mixture, int l) {
  double sum = 0.0;
  for (const PhaseMixture::Lobe& lobe : mixture.lobes)
    sum +=
        lobe.weight * std::visit([l](const auto& one) { return moment_by_g(one, l); }, lobe.phase);
  return sum;
}

}  // namespace

double legendre_moment_by_g(const PhaseFunction& phase, int l) {
  assert(l >= 0);
  return std::visit([l](const auto& one) { return moment_by_g(one, l); }, phase);
}

}  // namespace lamina
