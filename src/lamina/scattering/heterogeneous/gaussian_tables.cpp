// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/gaussian_tables.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "lamina/core/dense_matrix.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/diffusion/multipole.h"
#include "lamina/scattering/heterogeneous/internal/operator_profile.h"
#include "lamina/scattering/heterogeneous/internal/operator_totals.h"
#include "lamina/scattering/profile/gaussian_fit.h"
#include "lamina/scattering/profile/layer_response.h"

namespace lamina {
namespace {

/// Frequencies in a geometric series, and 0. Every second one is used for the fit, all for its
/// error.
std::vector<double> test_frequencies(const std::vector<double>& variances) {
  constexpr int count = 220;
  const double first = 0.05 / std::sqrt(variances.back()), last = highest_fitted_frequency;
  std::vector<double> k = {0.0};
  for (int i = 0; i < count; ++i) k.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return k;
}

/// [k][Gaussian]
DenseMatrix gaussians_at(const std::vector<double>& k, const std::vector<double>& variances) {
  DenseMatrix g(k.size(), variances.size());
  for (std::size_t j = 0; j < g.rows; ++j)
    for (std::size_t i = 0; i < g.columns; ++i)
      g(j, i) = std::exp(-0.5 * k[j] * k[j] * variances[i]);
  return g;
}

/// The matrix that turns a spectrum at every second frequency into weights: of least squares, held
/// small by a ridge.
DenseMatrix fitting_matrix(const DenseMatrix& all, double ridge) {
  constexpr double weight_of_total = 30.0;
  const std::size_t frequencies = (all.rows + 1) / 2;
  DenseMatrix a(frequencies + all.columns, all.columns), unit(a.rows, frequencies);
  for (std::size_t j = 0; j < frequencies; ++j) {
    std::ranges::copy(all.row(2 * j), a.row(j).begin());
    unit(j, j) = 1.0;
  }
  for (double& value : a.row(0)) value *= weight_of_total;
  for (std::size_t i = 0; i < all.columns; ++i)
    a(frequencies + i, i) = ridge * std::sqrt(static_cast<double>(frequencies));
  DenseMatrix fit = solve_least_squares(a, unit);
  for (std::size_t i = 0; i < fit.rows; ++i) fit(i, 0) *= weight_of_total;
  return fit;
}

/// Spectra of one operator, [row][k], as weights with the same totals.
GaussianTable fit(const DenseMatrix& spectra, const DenseMatrix& gaussians,
                  const DenseMatrix& fitting) {
  DenseMatrix shapes = spectra, fitted((shapes.columns + 1) / 2, shapes.rows);
  for (std::size_t row = 0; row < shapes.rows; ++row) {
    if (const double total = shapes(row, 0); total > 0.0)
      for (double& value : shapes.row(row)) value /= total;
    for (std::size_t j = 0; j < fitted.rows; ++j) fitted(j, row) = shapes(row, 2 * j);
  }
  DenseMatrix weights = transpose(multiply(fitting, fitted));
  const DenseMatrix found = multiply(weights, transpose(gaussians));
  GaussianTable table;
  for (std::size_t row = 0; row < shapes.rows; ++row) {
    double error = 0.0, sum = 0.0;
    for (std::size_t j = 0; j < shapes.columns; ++j)
      error = std::max(error, std::abs(found(row, j) - shapes(row, j)));
    table.error.push_back(error);
    for (const double weight : weights.row(row)) sum += weight;
    if (sum != 0.0)
      for (double& weight : weights.row(row)) weight *= spectra(row, 0) / sum;
  }
  table.weights = std::move(weights.values);
  return table;
}

/// R+, T+, R-, T- of a layer by the closed form, each [row][k].
using LayerSpectra = std::array<DenseMatrix, 4>;

LayerSpectra closed_form(const MappedStack& stack, std::size_t i, const GaussianTableGrid& grid,
                         const std::vector<double>& k) {
  const MappedLayer& layer = stack.layers[i];
  const auto [top, bottom] = detail::boundary_reflectances(stack, i);
  LayerSpectra spectra;
  spectra.fill(DenseMatrix(grid.rows, k.size()));
  for (std::size_t row = 0; row < grid.rows; ++row) {
    const Medium medium{.sigma_a = row_absorption(grid, static_cast<double>(row)),
                        .sigma_s = layer.sigma_s,
                        .g = layer.g,
                        .ior = layer.ior};
    const Multipole multipole = make_multipole(medium, layer.thickness, top, bottom);
    for (std::size_t j = 0; j < k.size(); ++j) {
      const LayerResponse r = response(multipole, k[j]);
      const auto at = [&](std::size_t which) -> double& { return spectra[which](row, j); };
      at(0) = r.reflection_above, at(1) = r.transmission_down;
      at(2) = r.reflection_below, at(3) = r.transmission_up;
    }
  }
  return spectra;
}

void scale_to(const detail::LayerTotals& totals, LayerSpectra& spectra) {
  for (std::size_t which = 0; which < 4; ++which)
    for (std::size_t row = 0; row < spectra[which].rows; ++row)
      if (const double closed = spectra[which](row, 0); closed > 0.0)
        for (double& value : spectra[which].row(row)) value *= totals[which][row] / closed;
}

/// A layer's response at an absorption between rows.
LayerResponse response_at(const LayerSpectra& spectra, const GaussianTableGrid& grid,
                          double sigma_a, std::size_t j) {
  const detail::FourRows near =
      detail::four_rows(std::log(sigma_a / grid.lowest) / std::log(grid.highest / grid.lowest) *
                            static_cast<double>(grid.rows - 1),
                        grid.rows);
  std::array<double, 4> values{};
  for (std::size_t which = 0; which < 4; ++which)
    for (std::size_t r = 0; r < 4; ++r)
      values[which] += near.share[r] * spectra[which](near.first + r, j);
  return {values[0], values[1], values[2], values[3]};
}

/// Changes the first layer's R+ so that the whole stack reflects as `shapes` say, wherever the
/// layers below are at their reference absorption.
void correct_profile(std::vector<LayerSpectra>& spectra, const GaussianTableGrid& grid,
                     std::span<const double> reference_sigma_a, const std::vector<double>& k,
                     const std::vector<std::vector<double>>& shapes) {
  LayerSpectra& first = spectra[0];
  std::vector<double> whole_at_0(grid.rows, 0.0), last_factor(grid.rows, 1.0);
  for (std::size_t j = 0; j < k.size(); ++j) {
    LayerResponse below{0.0, 1.0, 0.0, 1.0};
    for (std::size_t i = 1; i < spectra.size(); ++i)
      below = stacked(below, response_at(spectra[i], grid, reference_sigma_a[i], j));
    for (std::size_t row = 0; row < grid.rows; ++row) {
      const LayerResponse top{first[0](row, j), first[1](row, j), first[2](row, j),
                              first[3](row, j)};
      const double whole = stacked(top, below).reflection_above;
      if (j == 0) whole_at_0[row] = whole;
      double& factor = last_factor[row];  // stays as it is where frequencies are too high
      if (k[j] <= detail::highest_transfer_frequency)
        factor = whole_at_0[row] * shapes[row][j] / whole;
      first[0](row, j) += (factor - 1.0) * whole;
    }
  }
}

}  // namespace

double row_absorption(const GaussianTableGrid& grid, double row) {
  return grid.lowest *
         std::pow(grid.highest / grid.lowest, row / static_cast<double>(grid.rows - 1));
}

StackTables make_stack_tables(const MappedStack& stack, OperatorTotals totals,
                              std::span<const double> reference_sigma_a,
                              const GaussianTableGrid& grid) {
  assert(grid.rows >= 4 && grid.gaussians >= 1 && !stack.layers.empty());
  StackTables result{
      .grid = grid,
      .variances = doubling_variances(grid.first_variance, static_cast<int>(grid.gaussians)),
      .layers = {}};
  const std::vector<double> k = test_frequencies(result.variances);
  const DenseMatrix gaussians = gaussians_at(k, result.variances);
  const DenseMatrix fitting = fitting_matrix(gaussians, grid.ridge);
  std::vector<LayerSpectra> spectra;
  for (std::size_t i = 0; i < stack.layers.size(); ++i)
    spectra.push_back(closed_form(stack, i, grid, k));
  if (totals != OperatorTotals::diffusion) {
    const auto wanted = detail::transfer_operator_totals(
        stack, reference_sigma_a, grid, totals == OperatorTotals::radiative_transfer_diffuse);
    for (std::size_t i = 0; i < spectra.size(); ++i) scale_to(wanted[i], spectra[i]);
  }
  if (totals == OperatorTotals::radiative_transfer_profile)
    correct_profile(spectra, grid, reference_sigma_a, k,
                    detail::transfer_stack_shapes(stack, reference_sigma_a, grid, k));
  for (std::size_t i = 0; i < spectra.size(); ++i) {
    const bool is_half_space = std::isinf(stack.layers[i].thickness);
    const auto table = [&](std::size_t which) {
      return which > 0 && is_half_space ? GaussianTable{}
                                        : fit(spectra[i][which], gaussians, fitting);
    };
    result.layers.push_back({table(0), table(1), table(2), table(3)});
  }
  return result;
}

std::vector<double> weights_at(const StackTables& tables, const GaussianTable& table,
                               double sigma_a) {
  const GaussianTableGrid& grid = tables.grid;
  const detail::FourRows near =
      detail::four_rows(std::log(sigma_a / grid.lowest) / std::log(grid.highest / grid.lowest) *
                            static_cast<double>(grid.rows - 1),
                        grid.rows);
  const std::size_t size = tables.variances.size();
  std::vector<double> weights(size, 0.0);
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t i = 0; i < size; ++i)
      weights[i] += near.share[r] * table.weights[(near.first + r) * size + i];
  return weights;
}

}  // namespace lamina
