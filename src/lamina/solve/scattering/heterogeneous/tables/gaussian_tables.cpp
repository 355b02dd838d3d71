// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/multipole.h"
#include "lamina/solve/scattering/heterogeneous/tables/internal/operator_profile.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_totals.h"
#include "lamina/solve/scattering/profile/gaussian_fit.h"
#include "lamina/solve/scattering/profile/layer_response.h"

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

LayerSpectra closed_form(const MappedStack& stack, std::size_t i, const StateLattice& lattice,
                         const std::vector<double>& k) {
  const std::size_t nodes = node_count(lattice);
  LayerSpectra spectra;
  spectra.fill(DenseMatrix(nodes, k.size()));
  double roughness = -1.0, top = 0.0, bottom = 0.0;
  for (std::size_t node = 0; node < nodes; ++node) {
    const LayerState state = node_state(lattice, node);
    if (state.roughness != roughness) {
      roughness = state.roughness;
      std::tie(top, bottom) = detail::boundary_reflectances(stack, i, roughness);
    }
    const Medium medium{.sigma_a = state.sigma_a,
                        .sigma_s = state.sigma_s,
                        .g = state.g,
                        .ior = stack.layers[i].ior};
    const Multipole multipole = make_multipole(medium, state.thickness, top, bottom);
    for (std::size_t j = 0; j < k.size(); ++j) {
      const LayerResponse r = response(multipole, k[j]);
      const auto at = [&](std::size_t which) -> double& { return spectra[which](node, j); };
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

/// A layer's response between nodes.
LayerResponse response_at(const LayerSpectra& spectra, const StateLattice& lattice,
                          const LatticePlace& place, std::size_t j) {
  std::array<double, 4> values{};
  for_nodes_around(lattice, place, [&](std::size_t node, double share) {
    for (std::size_t which = 0; which < 4; ++which)
      values[which] += share * spectra[which](node, j);
  });
  return {values[0], values[1], values[2], values[3]};
}

/// Changes the first layer's R+ so that the whole stack reflects as `shapes` say, wherever the
/// layers below are at their reference states.
void correct_profile(std::vector<LayerSpectra>& spectra, std::span<const StateLattice> lattices,
                     std::span<const LayerState> reference, const std::vector<double>& k,
                     const std::vector<std::vector<double>>& shapes) {
  LayerSpectra& first = spectra[0];
  const std::size_t nodes = first[0].rows;
  std::vector<double> whole_at_0(nodes, 0.0), last_factor(nodes, 1.0);
  std::vector<LatticePlace> places;
  for (std::size_t i = 0; i < spectra.size(); ++i)
    places.push_back(place_in(lattices[i], reference[i]));
  for (std::size_t j = 0; j < k.size(); ++j) {
    LayerResponse below{0.0, 1.0, 0.0, 1.0};
    for (std::size_t i = 1; i < spectra.size(); ++i)
      below = stacked(below, response_at(spectra[i], lattices[i], places[i], j));
    for (std::size_t row = 0; row < nodes; ++row) {
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

StateLattice lattice_of(const MappedLayer& layer, const GaussianTableGrid& grid) {
  return layer.states.value_or(absorption_lattice({.sigma_a = grid.lowest,
                                                   .sigma_s = layer.sigma_s,
                                                   .g = layer.g,
                                                   .thickness = layer.thickness},
                                                  grid.lowest, grid.highest, grid.rows));
}

LayerState reference_state(const MappedLayer& layer, double sigma_a) {
  if (layer.states) return state_of(layer.states->origin);
  return {.sigma_a = sigma_a, .sigma_s = layer.sigma_s, .g = layer.g, .thickness = layer.thickness};
}

StackTables make_stack_tables(const MappedStack& stack, OperatorTotals totals,
                              std::span<const double> reference_sigma_a,
                              const GaussianTableGrid& grid, const Progress& progress) {
  assert(grid.rows >= 4 && grid.gaussians >= 1 && !stack.layers.empty());
  StackTables result{
      .grid = grid,
      .variances = doubling_variances(grid.first_variance, static_cast<int>(grid.gaussians)),
      .ground_reflectance = stack.ground_reflectance,
      .lattices = {},
      .layers = {}};
  for (const MappedLayer& layer : stack.layers) result.lattices.push_back(lattice_of(layer, grid));
  const std::vector<double> k = test_frequencies(result.variances);
  const DenseMatrix gaussians = gaussians_at(k, result.variances);
  const DenseMatrix fitting = fitting_matrix(gaussians, grid.ridge);
  std::vector<LayerSpectra> spectra;
  for (std::size_t i = 0; i < stack.layers.size(); ++i)
    spectra.push_back(closed_form(stack, i, result.lattices[i], k));
  report_or_throw(progress, 0.0);
  if (totals != OperatorTotals::diffusion) {
    std::vector<LayerState> reference;
    for (std::size_t i = 0; i < stack.layers.size(); ++i)
      reference.push_back(
          reference_state(stack.layers[i], stack.layers[i].states ? 0.0 : reference_sigma_a[i]));
    const bool has_profile = totals == OperatorTotals::radiative_transfer_profile;
    const auto wanted = detail::transfer_operator_totals(
        stack, result.lattices, reference, totals == OperatorTotals::radiative_transfer_diffuse,
        part_of(progress, 0.0, has_profile ? 0.2 : 0.9));
    for (std::size_t i = 0; i < spectra.size(); ++i) scale_to(wanted[i], spectra[i]);
    if (has_profile)
      correct_profile(spectra, result.lattices, reference, k,
                      detail::transfer_stack_shapes(stack, reference, result.lattices[0], k,
                                                    part_of(progress, 0.2, 0.9)));
  }
  for (std::size_t i = 0; i < spectra.size(); ++i) {
    const bool is_half_space = std::isinf(stack.layers[i].thickness);
    const auto table = [&](std::size_t which) {
      return which > 0 && is_half_space ? GaussianTable{}
                                        : fit(spectra[i][which], gaussians, fitting);
    };
    result.layers.push_back({table(0), table(1), table(2), table(3)});
    report_or_throw(progress,
                    0.9 + 0.1 * static_cast<double>(i + 1) / static_cast<double>(spectra.size()));
  }
  return result;
}

std::vector<double> weights_at(const StateLattice& lattice, const GaussianTable& table,
                               const LatticePlace& place) {
  const std::size_t size = table.weights.size() / node_count(lattice);
  std::vector<double> weights(size, 0.0);
  for_nodes_around(lattice, place, [&](std::size_t node, double share) {
    for (std::size_t i = 0; i < size; ++i) weights[i] += share * table.weights[node * size + i];
  });
  return weights;
}

std::vector<double> weights_at(const StackTables& tables, const GaussianTable& table,
                               double sigma_a) {
  const GaussianTableGrid& grid = tables.grid;
  const StateLattice lattice =
      absorption_lattice({.sigma_s = 1.0}, grid.lowest, grid.highest, grid.rows);
  return weights_at(lattice, table, place_in(lattice, {.sigma_a = sigma_a, .sigma_s = 1.0}));
}

}  // namespace lamina
