// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/spatial_frequency/scaled_solver.h"

#include <cstddef>

namespace lamina::detail {
namespace {

constexpr int nodes_of_single = 32, modes_of_single = 21;

}  // namespace

ScaledSolver::ScaledSolver(const LayerStack& stack, int nodes, int modes, Illumination illumination,
                           const FrequencyResponse& flux)
    : solver_(make_frequency_solver(stack, nodes, modes)),
      is_diffuse_(illumination == Illumination::diffuse) {
  if (!is_diffuse_ && !solver_.top.is_rough) {
    single_ = make_frequency_solver(stack, nodes_of_single, modes_of_single);
    for (std::size_t l = 0; l < single_->stack.layers.size(); ++l)
      single_->stack.layers[l].sigma_t = solver_.stack.layers[l].sigma_t;
  }
  const double none = 0.0;
  const FrequencyResponse without_waves = at({&none, 1}).front();
  const auto factor = [](double known, double found) {
    return known > 0.0 && found > 0.0 ? known / found : 1.0;
  };
  scale_ = {factor(flux.reflectance, without_waves.reflectance),
            factor(flux.transmittance, without_waves.transmittance)};
}

std::vector<FrequencyResponse> ScaledSolver::at(std::span<const double> frequencies) const {
  auto found =
      is_diffuse_ ? diffuse_responses(solver_, frequencies) : responses(solver_, frequencies);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    if (single_) {
      const auto known = single_scattering_response(*single_, frequencies[i]);
      const auto on_grid = single_scattering_response(solver_, frequencies[i]);
      found[i].reflectance += known.reflectance - on_grid.reflectance;
      found[i].transmittance += known.transmittance - on_grid.transmittance;
    }
    found[i].reflectance *= scale_.reflectance;
    found[i].transmittance *= scale_.transmittance;
  }
  return found;
}

}  // namespace lamina::detail
