// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/scaled_solver.h"

#include <cstddef>

namespace lamina::detail {

ScaledSolver::ScaledSolver(const LayerStack& stack, int nodes, int modes, Illumination illumination,
                           const FrequencyResponse& flux)
    : solver_(make_frequency_solver(stack, nodes, modes)),
      is_diffuse_(illumination == Illumination::diffuse) {
  if (!is_diffuse_ && !solver_.top.is_rough) single_.emplace(stack, nodes, modes);
  const double none = 0.0;
  const FrequencyResponse without_waves = at({&none, 1}).front();
  scale_ = {scale_to(flux.reflectance, without_waves.reflectance),
            scale_to(flux.transmittance, without_waves.transmittance)};
}

std::vector<FrequencyResponse> ScaledSolver::at(std::span<const double> frequencies) const {
  auto found =
      is_diffuse_ ? diffuse_responses(solver_, frequencies) : responses(solver_, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    if (single_) {
      const FrequencyResponse lacking = single_->at(frequencies[i]);
      found[i].reflectance += lacking.reflectance;
      found[i].transmittance += lacking.transmittance;
    }
    found[i].reflectance *= scale_.reflectance;
    found[i].transmittance *= scale_.transmittance;
  }
  return found;
}

}  // namespace lamina::detail
