// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling_derivatives/internal/differentiated_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lamina/optics/phase_function_derivative.h"

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

/// [node] 1 less the share of scattered light that the quadrature of the nodes finds.
std::vector<double> lost_by_quadrature(const GridLayer& layer, const PhaseMode& mode, double all) {
  const std::size_t n = layer.cos.size();
  std::vector<double> lost(n, all);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      lost[j] -= 0.25 * layer.cos[i] * layer.weight[i] * layer.weight[i] *
                 (mode.forward(i, j) + mode.backward(i, j));
  return lost;
}

/// Of the matrices of transfer: scattering by a phase function of these moments, what of it goes
/// straight on, and what goes straight back.
TransferMatrices scattering_matrices(const GridLayer& layer, const PhaseMode& mode,
                                     const std::vector<double>& straight_on, double back,
                                     double factor) {
  const std::size_t n = layer.cos.size();
  TransferMatrices change{Matrix(n, n), Matrix(n, n)};
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      const double scattering = 0.25 * factor * layer.weight[i] * layer.weight[j];
      change.forward(i, j) = scattering * mode.forward(i, j);
      change.backward(i, j) = scattering * mode.backward(i, j);
    }
    change.forward(j, j) += straight_on[j] / layer.cos[j];
    change.backward(j, j) += back / layer.cos[j];
  }
  return change;
}

TransferMatrices transfer_by_g(const Layer& layer, const GridLayer& on_grid,
                               const TruncatedPhase& phase, int count) {
  const double sigma_s = layer.medium.sigma_s;
  const TruncatedPhaseByG by_g = truncated_by_g(phase_function(layer), phase, count);
  const double kept_by_g = -by_g.forward_peak - by_g.backward_peak;
  // sigma_s times the phase function: the product rule.
  std::vector<double> moments = by_g.moments;
  for (std::size_t l = 0; l < moments.size(); ++l)
    moments[l] = sigma_s * kept_by_g * (l < phase.moments.size() ? phase.moments[l] : 0.0) +
                 on_grid.sigma_s * moments[l];
  const PhaseMode mode = phase_mode(moments, on_grid.cos, 0);
  std::vector<double> straight_on = lost_by_quadrature(on_grid, mode, sigma_s * kept_by_g);
  for (double& on : straight_on) on += sigma_s * by_g.forward_peak;
  return scattering_matrices(on_grid, mode, straight_on, sigma_s * by_g.backward_peak, 1.0);
}

/// Light scattered once, per sigma_s, in a layer that does not scatter.
LayerOperators first_scattering(const GridLayer& layer, const TruncatedPhase& phase) {
  const std::size_t n = layer.cos.size();
  const double kept = 1.0 - phase.forward_peak - phase.backward_peak;
  const PhaseMode mode = phase_mode(phase.moments, layer.cos, 0);
  std::vector<double> straight_on = lost_by_quadrature(layer, mode, 1.0);
  for (double& on : straight_on) on = kept * on + phase.forward_peak - 1.0;
  const auto [A, B] = scattering_matrices(layer, mode, straight_on, phase.backward_peak, kept);
  // (1 - exp(-x d)) / x, and the same difference of two exponentials.
  const auto decay = [&](double x) {
    return x == 0.0 ? layer.thickness : -std::expm1(-x * layer.thickness) / x;
  };
  LayerOperators once{Matrix(n, n), Matrix(n, n)};
  const std::size_t reached = std::min(n, layer.reach);
  for (std::size_t j = 0; j < reached; ++j)
    for (std::size_t i = 0; i < reached; ++i) {
      const double a = layer.sigma_a / layer.cos[i], b = layer.sigma_a / layer.cos[j];
      once.reflection(i, j) = B(i, j) * decay(a + b);
      const double weakest = std::exp(-std::min(a, b) * layer.thickness);
      if (weakest > 0.0) once.transmission(i, j) = A(i, j) * weakest * decay(std::abs(a - b));
    }
  return once;
}

DifferentiatedLayer differentiate_clear_layer(const GridLayer& layer, const TruncatedPhase& phase) {
  const std::size_t n = layer.cos.size();
  const LayerOperators none{Matrix(n, n), Matrix(n, n)};
  DifferentiatedLayer result{layer_operators(layer, 0), none, first_scattering(layer, phase), none,
                             none};
  if (!std::isfinite(layer.thickness)) return result;
  for (std::size_t i = 0; i < n; ++i) {
    const double per_length = -result.operators.transmission(i, i) / layer.cos[i];
    result.by_sigma_a.transmission(i, i) = layer.thickness * per_length;
    result.by_thickness.transmission(i, i) = layer.sigma_a * per_length;
  }
  return result;
}

/// One more thin slice at the bottom: dR/dd = T B T, dT/dd = (A + R B) T.
///
/// Source: [Chandrasekhar1960] §52, in matrices.
LayerOperators by_thickness(const LayerOperators& layer, const TransferMatrices& transfer) {
  const Matrix& T = layer.transmission;
  const Matrix BT = product(transfer.backward, T);
  LayerOperators derivative{product(T, BT), product(transfer.forward, T)};
  const Matrix RBT = product(layer.reflection, BT);
  for (std::size_t k = 0; k < RBT.values.size(); ++k)
    derivative.transmission.values[k] += RBT.values[k];
  return derivative;
}

/// A layer depends on sigma_a d and sigma_s d alone: sigma_s X_s = d X_d - sigma_a X_a.
Matrix by_scale(const Layer& layer, const Matrix& by_sigma_a, const Matrix& by_thickness) {
  Matrix by_sigma_s = by_sigma_a;
  const double d = std::isfinite(layer.thickness) ? layer.thickness : 0.0;
  for (std::size_t k = 0; k < by_sigma_s.values.size(); ++k)
    by_sigma_s.values[k] =
        (d * by_thickness.values[k] - layer.medium.sigma_a * by_sigma_a.values[k]) /
        layer.medium.sigma_s;
  return by_sigma_s;
}

}  // namespace

DifferentiatedLayer differentiate_layer(const Layer& layer, const GridLayer& on_grid,
                                        const DirectionGrid& grid) {
  const int count = carried_moments(grid, on_grid.ior);
  const TruncatedPhase phase = truncate(phase_function(layer), count);
  if (layer.medium.sigma_s == 0.0) return differentiate_clear_layer(on_grid, phase);

  const std::size_t n = on_grid.cos.size();
  const TransferMatrices transfer = transfer_matrices(on_grid, 0);
  TransferMatrices by_sigma_a{Matrix(n, n), Matrix(n, n)};
  for (std::size_t i = 0; i < n; ++i) by_sigma_a.forward(i, i) = -1.0 / on_grid.cos[i];
  const TransferMatrices by_g = transfer_by_g(layer, on_grid, phase, count);
  const auto derivative = [](const TransferMatrices& of) {
    return SlabProblemDerivative{of.forward.values.data(), of.backward.values.data()};
  };
  SlabProblem problem = slab_problem(on_grid, transfer);
  const std::vector<double> roots = root_etendues(on_grid);
  if (on_grid.sigma_a == 0.0) problem.conserved = roots.data();
  DifferentiatedSlab slab =
      double_slab_with_derivatives(problem, std::array{derivative(by_sigma_a), derivative(by_g)});
  if (!std::isfinite(layer.thickness)) {
    const Matrix nothing(n, n);
    slab.transmission = nothing;
    slab.transmission_derivatives.assign(2, nothing);
  }
  DifferentiatedLayer result{
      .operators = {std::move(slab.reflection), std::move(slab.transmission)},
      .by_sigma_a = {std::move(slab.reflection_derivatives[0]),
                     std::move(slab.transmission_derivatives[0])},
      .by_sigma_s = {},
      .by_g = {std::move(slab.reflection_derivatives[1]),
               std::move(slab.transmission_derivatives[1])},
      .by_thickness = {}};
  result.by_thickness = by_thickness(result.operators, transfer);
  result.by_sigma_s.reflection =
      by_scale(layer, result.by_sigma_a.reflection, result.by_thickness.reflection);
  result.by_sigma_s.transmission =
      by_scale(layer, result.by_sigma_a.transmission, result.by_thickness.transmission);
  return result;
}

}  // namespace lamina::detail
