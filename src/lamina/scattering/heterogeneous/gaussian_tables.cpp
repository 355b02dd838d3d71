// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/gaussian_tables.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/diffusion/multipole.h"
#include "lamina/scattering/heterogeneous/internal/operator_profile.h"
#include "lamina/scattering/heterogeneous/internal/operator_totals.h"
#include "lamina/scattering/profile/gaussian_fit.h"
#include "lamina/scattering/profile/layer_response.h"

namespace lamina {
namespace {

using Eigen::Index;
using MatrixOfRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Frequencies in a geometric series, and 0. Every second one is used for the fit, all for its
/// error.
std::vector<double> test_frequencies(const std::vector<double>& variances) {
  constexpr int count = 220;
  const double first = 0.05 / std::sqrt(variances.back()), last = highest_fitted_frequency;
  std::vector<double> k = {0.0};
  for (int i = 0; i < count; ++i) k.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return k;
}

MatrixOfRows gaussians_at(const std::vector<double>& k, const std::vector<double>& variances) {
  MatrixOfRows g(static_cast<Index>(k.size()), static_cast<Index>(variances.size()));
  for (Index j = 0; j < g.rows(); ++j)
    for (Index i = 0; i < g.cols(); ++i) {
      const double at = k[static_cast<std::size_t>(j)];
      g(j, i) = std::exp(-0.5 * at * at * variances[static_cast<std::size_t>(i)]);
    }
  return g;
}

/// The matrix that turns a spectrum at every second frequency into weights.
MatrixOfRows fitting_matrix(const MatrixOfRows& all, double ridge) {
  constexpr double weight_of_total = 30.0;
  MatrixOfRows a((all.rows() + 1) / 2, all.cols());
  for (Index j = 0; j < a.rows(); ++j) a.row(j) = all.row(2 * j);
  a.row(0) *= weight_of_total;
  const double size = static_cast<double>(a.rows());
  const Eigen::MatrixXd normal =
      a.transpose() * a + ridge * ridge * size * Eigen::MatrixXd::Identity(all.cols(), all.cols());
  MatrixOfRows fit = normal.ldlt().solve(Eigen::MatrixXd(a.transpose()));
  fit.col(0) *= weight_of_total;
  return fit;
}

/// Spectra of one operator, [row][k], as weights with the same totals.
GaussianTable fit(const MatrixOfRows& spectra, const MatrixOfRows& gaussians,
                  const MatrixOfRows& fitting) {
  MatrixOfRows shapes = spectra;
  for (Index row = 0; row < shapes.rows(); ++row)
    if (shapes(row, 0) > 0.0) shapes.row(row) /= shapes(row, 0);
  MatrixOfRows fitted((shapes.cols() + 1) / 2, shapes.rows());
  for (Index j = 0; j < fitted.rows(); ++j) fitted.row(j) = shapes.col(2 * j).transpose();
  MatrixOfRows weights = (fitting * fitted).transpose();
  const MatrixOfRows error = (weights * gaussians.transpose() - shapes).cwiseAbs();
  GaussianTable table;
  for (Index row = 0; row < shapes.rows(); ++row) {
    table.error.push_back(error.row(row).maxCoeff());
    const double sum = weights.row(row).sum();
    if (sum != 0.0) weights.row(row) *= spectra(row, 0) / sum;
  }
  table.weights.assign(weights.data(), weights.data() + weights.size());
  return table;
}

/// R+, T+, R-, T- of a layer by the closed form, each [row][k].
using LayerSpectra = std::array<MatrixOfRows, 4>;

LayerSpectra closed_form(const MappedStack& stack, std::size_t i, const GaussianTableGrid& grid,
                         const std::vector<double>& k) {
  const MappedLayer& layer = stack.layers[i];
  const auto [top, bottom] = detail::boundary_reflectances(stack, i);
  LayerSpectra spectra;
  for (MatrixOfRows& s : spectra)
    s.resize(static_cast<Index>(grid.rows), static_cast<Index>(k.size()));
  for (std::size_t row = 0; row < grid.rows; ++row) {
    const Medium medium{.sigma_a = row_absorption(grid, static_cast<double>(row)),
                        .sigma_s = layer.sigma_s,
                        .g = layer.g,
                        .ior = layer.ior};
    const Multipole multipole = make_multipole(medium, layer.thickness, top, bottom);
    for (std::size_t j = 0; j < k.size(); ++j) {
      const LayerResponse r = response(multipole, k[j]);
      const auto at = [&](std::size_t which) -> double& {
        return spectra[which](static_cast<Index>(row), static_cast<Index>(j));
      };
      at(0) = r.reflection_above, at(1) = r.transmission_down;
      at(2) = r.reflection_below, at(3) = r.transmission_up;
    }
  }
  return spectra;
}

void scale_to(const detail::LayerTotals& totals, LayerSpectra& spectra) {
  for (std::size_t which = 0; which < 4; ++which)
    for (Index row = 0; row < spectra[which].rows(); ++row)
      if (const double closed = spectra[which](row, 0); closed > 0.0)
        spectra[which].row(row) *= totals[which][static_cast<std::size_t>(row)] / closed;
}

/// A layer's response at an absorption between rows.
LayerResponse response_at(const LayerSpectra& spectra, const GaussianTableGrid& grid,
                          double sigma_a, Index j) {
  const detail::FourRows near =
      detail::four_rows(std::log(sigma_a / grid.lowest) / std::log(grid.highest / grid.lowest) *
                            static_cast<double>(grid.rows - 1),
                        grid.rows);
  std::array<double, 4> values{};
  for (std::size_t which = 0; which < 4; ++which)
    for (std::size_t r = 0; r < 4; ++r)
      values[which] += near.share[r] * spectra[which](static_cast<Index>(near.first + r), j);
  return {values[0], values[1], values[2], values[3]};
}

/// Changes the first layer's R+ so that the whole stack reflects as `shapes` say, wherever the
/// layers below are at their reference absorption.
void correct_profile(std::vector<LayerSpectra>& spectra, const GaussianTableGrid& grid,
                     std::span<const double> reference_sigma_a, const std::vector<double>& k,
                     const std::vector<std::vector<double>>& shapes) {
  LayerSpectra& first = spectra[0];
  std::vector<double> whole_at_0(grid.rows, 0.0), last_factor(grid.rows, 1.0);
  for (Index j = 0; j < first[0].cols(); ++j) {
    LayerResponse below{0.0, 1.0, 0.0, 1.0};
    for (std::size_t i = 1; i < spectra.size(); ++i)
      below = stacked(below, response_at(spectra[i], grid, reference_sigma_a[i], j));
    const auto column = static_cast<std::size_t>(j);
    for (std::size_t row = 0; row < grid.rows; ++row) {
      const auto r = static_cast<Index>(row);
      const LayerResponse top{first[0](r, j), first[1](r, j), first[2](r, j), first[3](r, j)};
      const double whole = stacked(top, below).reflection_above;
      if (j == 0) whole_at_0[row] = whole;
      double& factor = last_factor[row];  // stays as it is where frequencies are too high
      if (k[column] <= detail::highest_transfer_frequency)
        factor = whole_at_0[row] * shapes[row][column] / whole;
      first[0](r, j) += (factor - 1.0) * whole;
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
  const MatrixOfRows gaussians = gaussians_at(k, result.variances);
  const MatrixOfRows fitting = fitting_matrix(gaussians, grid.ridge);
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
