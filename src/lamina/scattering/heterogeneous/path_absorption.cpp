// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/path_absorption.h"

#include <cassert>
#include <cmath>

#include "lamina/optics/medium.h"

namespace lamina {

PathAbsorption::PathAbsorption(const LayerTexels& texels)
    : sigma_a_(texels.sigma_a),
      reduced_scattering_(static_cast<double>(texels.sigma_s[0]) *
                          (1.0 - static_cast<double>(texels.g[0]))) {
  assert(follows_absorption(texels));
}

void PathAbsorption::add_neighbors(std::size_t one, std::size_t other) {
  const double a = sigma_a_[one], b = sigma_a_[other];
  if (a == b) return;
  const auto decay = [&](double sigma_a) {
    return sigma_tr(Medium{.sigma_a = sigma_a, .sigma_s = reduced_scattering_, .g = 0.0});
  };
  decays_ += std::abs(a - b) * 0.5 * (decay(a) + decay(b));
  differences_ += std::abs(a - b);
}

double PathAbsorption::width() const {
  constexpr double part = 0.38;
  return decays_ > 0.0 ? part * differences_ / decays_ : 0.0;
}

bool follows_absorption(const LayerTexels& texels) {
  return varies_in_absorption_only(texels) && texels.sigma_a.size() > 1;
}

}  // namespace lamina
