// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/gaussian_tables.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "lamina/scattering/diffuse_boundary.h"
#include "lamina/scattering/gaussian_fit.h"
#include "lamina/scattering/multipole.h"
#include "lamina/scattering/operator_totals.h"

namespace lamina {
namespace {

using Eigen::Index;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Frequencies up to where the narrowest Gaussian has fallen to e^-2, and 0. Every second one is
/// used for the fit, all for its error.
std::vector<double> test_frequencies(const std::vector<double>& variances) {
  constexpr int count = 220;
  const double first = 0.05 / std::sqrt(variances.back()), last = 2.0 / std::sqrt(variances[1]);
  std::vector<double> k = {0.0};
  for (int i = 0; i < count; ++i) k.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return k;
}

Rows gaussians_at(const std::vector<double>& k, const std::vector<double>& variances) {
  Rows g(static_cast<Index>(k.size()), static_cast<Index>(variances.size()));
  for (Index j = 0; j < g.rows(); ++j)
    for (Index i = 0; i < g.cols(); ++i) {
      const double at = k[static_cast<std::size_t>(j)];
      g(j, i) = std::exp(-0.5 * at * at * variances[static_cast<std::size_t>(i)]);
    }
  return g;
}

/// The matrix that turns a spectrum at every second frequency into weights.
Rows fitting_matrix(const Rows& all, double ridge) {
  constexpr double weight_of_total = 30.0;
  Rows a((all.rows() + 1) / 2, all.cols());
  for (Index j = 0; j < a.rows(); ++j) a.row(j) = all.row(2 * j);
  a.row(0) *= weight_of_total;
  const double size = static_cast<double>(a.rows());
  const Eigen::MatrixXd normal =
      a.transpose() * a + ridge * ridge * size * Eigen::MatrixXd::Identity(all.cols(), all.cols());
  Rows fit = normal.ldlt().solve(Eigen::MatrixXd(a.transpose()));
  fit.col(0) *= weight_of_total;
  return fit;
}

/// Spectra of one operator, [row][k], as weights that are scaled to the totals.
GaussianTable fit(const Rows& spectra, const std::vector<double>& totals, const Rows& gaussians,
                  const Rows& fitting) {
  Rows shapes = spectra;
  for (Index row = 0; row < shapes.rows(); ++row)
    if (shapes(row, 0) > 0.0) shapes.row(row) /= shapes(row, 0);
  Rows fitted((shapes.cols() + 1) / 2, shapes.rows());
  for (Index j = 0; j < fitted.rows(); ++j) fitted.row(j) = shapes.col(2 * j).transpose();
  Rows weights = (fitting * fitted).transpose();
  const Rows error = (weights * gaussians.transpose() - shapes).cwiseAbs();
  GaussianTable table;
  for (Index row = 0; row < shapes.rows(); ++row) {
    table.error.push_back(error.row(row).maxCoeff());
    const double sum = weights.row(row).sum();
    if (sum != 0.0) weights.row(row) *= totals[static_cast<std::size_t>(row)] / sum;
  }
  table.weights.assign(weights.data(), weights.data() + weights.size());
  return table;
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
  const Rows gaussians = gaussians_at(k, result.variances);
  const Rows fitting = fitting_matrix(gaussians, grid.ridge);
  std::vector<detail::LayerTotals> exact;
  if (totals == OperatorTotals::exact)
    exact = detail::exact_operator_totals(stack, reference_sigma_a, grid);

  for (std::size_t i = 0; i < stack.layers.size(); ++i) {
    const MappedLayer& layer = stack.layers[i];
    const auto [top, bottom] = detail::boundary_reflectances(stack, i);
    std::array<Rows, 4> spectra;
    for (Rows& s : spectra) s.resize(static_cast<Index>(grid.rows), static_cast<Index>(k.size()));
    for (std::size_t row = 0; row < grid.rows; ++row) {
      const Medium medium{.sigma_a = row_absorption(grid, static_cast<double>(row)),
                          .sigma_s = layer.sigma_s,
                          .g = layer.g,
                          .ior = layer.ior};
      const Multipole multipole = make_multipole(medium, layer.thickness, top, bottom);
      for (std::size_t j = 0; j < k.size(); ++j) {
        const LayerResponse r = spread_source_response(multipole, k[j]);
        const auto at = [&](std::size_t which) -> double& {
          return spectra[which](static_cast<Index>(row), static_cast<Index>(j));
        };
        at(0) = r.reflection_above, at(1) = r.transmission_down;
        at(2) = r.reflection_below, at(3) = r.transmission_up;
      }
    }
    std::array<GaussianTable, 4> tables;
    const bool is_half_space = std::isinf(layer.thickness);
    for (std::size_t which = 0; which < (is_half_space ? 1u : 4u); ++which) {
      const Eigen::VectorXd closed_form = spectra[which].col(0);
      const std::vector<double> of_closed_form(closed_form.begin(), closed_form.end());
      tables[which] =
          fit(spectra[which], exact.empty() ? of_closed_form : exact[i][which], gaussians, fitting);
    }
    result.layers.push_back(
        {std::move(tables[0]), std::move(tables[1]), std::move(tables[2]), std::move(tables[3])});
  }
  return result;
}

std::vector<double> weights_at(const StackTables& tables, const GaussianTable& table,
                               double sigma_a) {
  const GaussianTableGrid& grid = tables.grid;
  const double last = static_cast<double>(grid.rows - 1);
  const double row = std::clamp(
      std::log(sigma_a / grid.lowest) / std::log(grid.highest / grid.lowest) * last, 0.0, last);
  // Lagrange's polynomial through four rows
  const double first = std::clamp(std::floor(row) - 1.0, 0.0, last - 3.0);
  const double u = row - first;
  const std::array<double, 4> share = {(u - 1) * (u - 2) * (u - 3) / -6, u * (u - 2) * (u - 3) / 2,
                                       u * (u - 1) * (u - 3) / -2, u * (u - 1) * (u - 2) / 6};
  const std::size_t size = tables.variances.size();
  std::vector<double> weights(size, 0.0);
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t i = 0; i < size; ++i)
      weights[i] += share[r] * table.weights[(static_cast<std::size_t>(first) + r) * size + i];
  return weights;
}

}  // namespace lamina
