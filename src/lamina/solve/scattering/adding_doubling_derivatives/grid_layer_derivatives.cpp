// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling_derivatives/grid_layer_derivatives.h"

#include <cstddef>
#include <utility>

#include "lamina/layers/optics/phase_function_derivative.h"

namespace lamina::detail {
namespace {

/// How the truncated phase function changes with g.
struct TruncatedPhaseByG {
  std::vector<double> moments;
  double forward_peak = 0.0, backward_peak = 0.0;
};

/// `truncate` differentiated. Moments that vanish at g = 0 may grow from there.
TruncatedPhaseByG truncated_by_g(const PhaseFunction& phase, const TruncatedPhase& truncated,
                                 int count) {
  TruncatedPhaseByG by_g;
  for (int l = 0; l < count; ++l) by_g.moments.push_back(legendre_moment_by_g(phase, l));
  const double peak = truncated.forward_peak + truncated.backward_peak;
  if (peak == 0.0) return by_g;
  const bool is_backward = truncated.backward_peak != 0.0;
  const double peak_by_g = legendre_moment_by_g(phase, count);
  (is_backward ? by_g.backward_peak : by_g.forward_peak) = peak_by_g;
  for (std::size_t l = 0; l < by_g.moments.size(); ++l) {
    const double sign = is_backward && l % 2 == 1 ? -1.0 : 1.0;
    const double moment = l < truncated.moments.size() ? truncated.moments[l] : 0.0;
    by_g.moments[l] = (by_g.moments[l] - peak_by_g * sign + peak_by_g * moment) / (1.0 - peak);
  }
  return by_g;
}

/// [node] Scattering by these moments as the quadrature of the nodes finds it. What it does not
/// find goes straight on, and is no extinction.
std::vector<double> found_by_quadrature(const GridLayer& layer,
                                        const std::vector<double>& moments) {
  const PhaseMode mode = phase_mode(moments, layer.cos, 0);
  const std::size_t n = layer.cos.size();
  std::vector<double> found(n, 0.0);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      found[j] += 0.25 * layer.cos[i] * layer.weight[i] * layer.weight[i] *
                  (mode.forward(i, j) + mode.backward(i, j));
  return found;
}

/// Of a change of scattering by these moments, and straight back.
GridLayerDerivative of_scattering(const GridLayer& layer, std::vector<double> moments,
                                  double backward) {
  std::vector<double> extinction = found_by_quadrature(layer, moments);
  for (double& of_node : extinction) of_node += backward;
  return {std::move(moments), std::move(extinction), backward};
}

}  // namespace

GridLayerDerivatives grid_layer_derivatives(const Layer& layer, const GridLayer& on_grid,
                                            const DirectionGrid& grid) {
  const int count = carried_moments(grid, on_grid.ior);
  const TruncatedPhase phase = truncate(phase_function(layer), count);
  const TruncatedPhaseByG by_g = truncated_by_g(phase_function(layer), phase, count);
  const double kept = 1.0 - phase.forward_peak - phase.backward_peak;
  const double kept_by_g = -by_g.forward_peak - by_g.backward_peak;
  const double sigma_s = layer.medium.sigma_s;
  std::vector<double> moments_by_sigma_s, moments_by_g;
  for (std::size_t l = 0; l < by_g.moments.size(); ++l) {
    const double moment = l < phase.moments.size() ? phase.moments[l] : 0.0;
    moments_by_sigma_s.push_back(kept * moment);
    moments_by_g.push_back(sigma_s * (kept_by_g * moment + kept * by_g.moments[l]));
  }
  // By name, as gcc 12 frees members of an aggregate twice if a later one throws.
  GridLayerDerivatives result;
  result.by_sigma_a.extinction.assign(on_grid.cos.size(), 1.0);
  result.by_sigma_s = of_scattering(on_grid, std::move(moments_by_sigma_s), phase.backward_peak);
  result.by_g = of_scattering(on_grid, std::move(moments_by_g), sigma_s * by_g.backward_peak);
  return result;
}

}  // namespace lamina::detail
