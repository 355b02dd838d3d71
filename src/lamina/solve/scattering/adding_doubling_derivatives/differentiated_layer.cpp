// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling_derivatives/differentiated_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lamina/solve/scattering/adding_doubling_derivatives/grid_layer_derivatives.h"

namespace lamina::detail {
namespace {

TransferMatrices transfer_by(const GridLayer& layer, const GridLayerDerivative& by) {
  const std::size_t n = layer.cos.size();
  const PhaseMode mode = phase_mode(by.moments, layer.cos, 0);
  TransferMatrices change{Matrix(n, n), Matrix(n, n)};
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      const double scattering = 0.25 * layer.weight[i] * layer.weight[j];
      change.forward(i, j) = scattering * mode.forward(i, j);
      change.backward(i, j) = scattering * mode.backward(i, j);
    }
    change.forward(j, j) -= by.extinction[j] / layer.cos[j];
    change.backward(j, j) += by.backward / layer.cos[j];
  }
  return change;
}

/// Light scattered once, per sigma_s, in a layer that does not scatter.
LayerOperators first_scattering(const GridLayer& layer, const GridLayerDerivative& by_sigma_s) {
  const std::size_t n = layer.cos.size();
  const auto [A, B] = transfer_by(layer, by_sigma_s);
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

DifferentiatedLayer differentiate_clear_layer(const GridLayer& layer,
                                              const GridLayerDerivative& by_sigma_s) {
  const std::size_t n = layer.cos.size();
  const LayerOperators none{Matrix(n, n), Matrix(n, n)};
  DifferentiatedLayer result{layer_operators(layer, 0), none, first_scattering(layer, by_sigma_s),
                             none, none};
  if (!std::isfinite(layer.thickness)) return result;
  for (std::size_t i = 0; i < n; ++i) {
    const double per_length = -result.operators.transmission(i, i) / layer.cos[i];
    result.by_sigma_a.transmission(i, i) = layer.thickness * per_length;
    result.by_thickness.transmission(i, i) = layer.sigma_a * per_length;
  }
  return result;
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

LayerOperators by_thickness(const LayerOperators& layer, const Matrix& A, const Matrix& B) {
  const Matrix& T = layer.transmission;
  const Matrix BT = product(B, T);
  LayerOperators derivative{product(T, BT), product(A, T)};
  const Matrix RBT = product(layer.reflection, BT);
  for (std::size_t k = 0; k < RBT.values.size(); ++k)
    derivative.transmission.values[k] += RBT.values[k];
  return derivative;
}

DifferentiatedLayer differentiate_layer(const Layer& layer, const GridLayer& on_grid,
                                        const DirectionGrid& grid) {
  const GridLayerDerivatives of_layer = grid_layer_derivatives(layer, on_grid, grid);
  if (layer.medium.sigma_s == 0.0) return differentiate_clear_layer(on_grid, of_layer.by_sigma_s);

  const std::size_t n = on_grid.cos.size();
  const TransferMatrices transfer = transfer_matrices(on_grid, 0);
  const TransferMatrices by_sigma_a = transfer_by(on_grid, of_layer.by_sigma_a);
  const TransferMatrices by_g = transfer_by(on_grid, of_layer.by_g);
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
  result.by_thickness = by_thickness(result.operators, transfer.forward, transfer.backward);
  result.by_sigma_s.reflection =
      by_scale(layer, result.by_sigma_a.reflection, result.by_thickness.reflection);
  result.by_sigma_s.transmission =
      by_scale(layer, result.by_sigma_a.transmission, result.by_thickness.transmission);
  return result;
}

}  // namespace lamina::detail
