// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/band_color.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/base/core/dense_matrix.h"

namespace lamina {
namespace {

const BandWeights identity = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

/// How alike a spectrum is at two wavelengths [nm]: Matérn's correlation of smoothness 5/2. Its
/// length is that which serves measured skin and random smooth spectra best (60 to 250 nm tried).
double correlation(double a, double b) {
  constexpr double length = 150.0;  // [nm]
  const double r = std::sqrt(5.0) * std::abs(a - b) / length;
  return (1.0 + r + r * r / 3.0) * std::exp(-r);
}

/// Weights of the bands for the integrals of each column of `response`, [row of the table].
/// They sum to the sum of the column: the estimate of a constant spectrum is that constant.
DenseMatrix estimate_weights(std::span<const double> bands, const DenseMatrix& response) {
  // Ordinary kriging: correlations between bands, bordered by the condition on the sum.
  const std::size_t n = bands.size();
  const auto table = color_matching_table();
  DenseMatrix system(n + 1, n + 1), to_table(n + 1, table.size());
  for (std::size_t i = 0; i < n; ++i) {
    system(i, n) = system(n, i) = 1.0;
    for (std::size_t j = 0; j < n; ++j) system(i, j) = correlation(bands[i], bands[j]);
    for (std::size_t row = 0; row < table.size(); ++row)
      to_table(i, row) = correlation(bands[i], table[row].wavelength);
  }
  for (double& value : to_table.row(n)) value = 1.0;
  return solve_linear(system, multiply(to_table, response));
}

/// Rounds the weights of a channel to multiples of 2^-22 that sum to 1. Sums of them with ones are
/// then exact in float, too, and in any order.
void make_sum_exact(BandWeights& weights, std::size_t channel) {
  constexpr double unit = 0x1p-22;
  std::size_t largest = 0;
  double sum = 0.0;
  for (std::size_t b = 0; b < weights.size(); ++b) {
    double& weight = weights[b][channel];
    weight = unit * std::round(weight / unit);
    sum += weight;
    if (std::abs(weight) > std::abs(weights[largest][channel])) largest = b;
  }
  weights[largest][channel] += 1.0 - sum;
}

/// The smoothest spectra of red and blue, stacked, for weights [3, band]: least squares of the
/// slopes of all three spectra (green is what red and blue leave of 1) and of their negative parts,
/// under the exact condition that each gives its colour.
std::vector<double> smooth_primaries(std::span<const double> bands, const DenseMatrix& weights) {
  const std::size_t n = weights.columns;
  const double mean_step = (bands.back() - bands.front()) / static_cast<double>(n - 1);
  DenseMatrix roughness(n, n);
  for (std::size_t i = 0; i < n; ++i) roughness(i, i) = 1e-6;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double weight = mean_step / (bands[i + 1] - bands[i]);
    roughness(i, i) += weight;
    roughness(i + 1, i + 1) += weight;
    roughness(i, i + 1) = roughness(i + 1, i) = -weight;
  }

  std::vector<double> x(2 * n, 0.0);
  std::vector<bool> is_negative(3 * n, false);
  for (int round = 0; round < 60; ++round) {
    // Quadratic in x = (red, blue): x' H x - 2 f' x, where green = 1 - red - blue.
    constexpr double penalty = 1e3;  // of the square of a negative value, against that of a slope
    const auto weighted = [&](std::size_t primary) {
      DenseMatrix quadratic = roughness;
      for (std::size_t i = 0; i < n; ++i)
        if (is_negative[primary * n + i]) quadratic(i, i) += penalty;
      return quadratic;
    };
    const DenseMatrix red = weighted(0), blue = weighted(1), green = weighted(2);
    DenseMatrix system(2 * n + 6, 2 * n + 6), right(2 * n + 6, 1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        system(i, j) = red(i, j) + green(i, j);
        system(n + i, n + j) = blue(i, j) + green(i, j);
        system(i, n + j) = system(n + i, j) = green(i, j);
        right(i, 0) += green(i, j);
        right(n + i, 0) += green(i, j);
      }
    for (std::size_t primary = 0; primary < 2; ++primary)
      for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < n; ++i) {
          const std::size_t row = 2 * n + 3 * primary + channel, column = primary * n + i;
          system(row, column) = system(column, row) = weights(channel, i);
        }
    right(2 * n, 0) = right(2 * n + 5, 0) = 1.0;  // red is (1, 0, 0), blue (0, 0, 1)
    const DenseMatrix solution = solve_linear(system, right);
    x.assign(solution.values.begin(), solution.values.begin() + static_cast<std::ptrdiff_t>(2 * n));

    bool is_settled = true;
    for (std::size_t i = 0; i < n; ++i) {
      const std::array<double, 3> values = {x[i], x[n + i], 1.0 - x[i] - x[n + i]};
      for (std::size_t primary = 0; primary < 3; ++primary) {
        const bool now = values[primary] < 0.0;
        auto before = is_negative[primary * n + i];
        is_settled = is_settled && now == before;
        before = now;
      }
    }
    if (is_settled) break;
  }
  return x;
}

/// [channel][band]
DenseMatrix as_matrix(const BandWeights& weights) {
  DenseMatrix matrix(3, weights.size());
  for (std::size_t b = 0; b < weights.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c) matrix(c, b) = weights[b][c];
  return matrix;
}

}  // namespace

BandWeights make_band_weights(const BandSet& bands, Illuminant illuminant) {
  if (bands.is_rgb()) return identity;
  const Xyz white = white_point(illuminant);
  const Matrix3 to_srgb = xyz_to_linear_srgb() * bradford_adaptation(white, srgb_white());
  const auto table = color_matching_table();
  DenseMatrix response(table.size(), 3);  // of linear sRGB at each wavelength
  double luminance = 0.0;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const double power = illuminant_power(illuminant, table[row].wavelength);
    luminance += power * table[row].y;
    const std::array<double, 3> rgb = to_srgb * Xyz{table[row].x, table[row].y, table[row].z};
    for (std::size_t c = 0; c < 3; ++c) response(row, c) = power * rgb[c];
  }
  for (double& value : response.values) value /= luminance;
  const DenseMatrix estimated = estimate_weights(bands.wavelengths(), response);
  BandWeights weights(bands.size());
  for (std::size_t b = 0; b < weights.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c) weights[b][c] = estimated(b, c);
  for (std::size_t c = 0; c < 3; ++c) make_sum_exact(weights, c);
  return weights;
}

LinearSrgb linear_srgb(const BandWeights& weights, std::span<const double> spectrum) {
  assert(weights.size() == spectrum.size());
  LinearSrgb color{};
  for (std::size_t b = 0; b < weights.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c) color[c] += weights[b][c] * spectrum[b];
  return color;
}

BandBasis make_band_basis(const BandSet& bands, Illuminant illuminant) {
  return make_band_basis(bands, make_band_weights(bands, illuminant));
}

bool tells_colors(const BandWeights& weights) {
  // Colours that the bands cannot show would take spectra far below 0 and above 1.
  constexpr double least_distinction = 0.02;
  if (weights.size() < 3) return false;
  const std::vector<double> strengths = singular_values(as_matrix(weights));
  return strengths[2] >= least_distinction * strengths[0];
}

BandBasis make_band_basis(const BandSet& bands, const BandWeights& weights) {
  if (bands.is_rgb()) return identity;
  const std::size_t n = bands.size();
  const DenseMatrix matrix = as_matrix(weights);
  if (!tells_colors(weights)) {
    const std::array<double, 3> luminance = linear_srgb_to_xyz()[1];
    return BandBasis(n, luminance);
  }
  const std::vector<double> primaries = smooth_primaries(bands.wavelengths(), matrix);
  BandBasis basis(n);
  for (std::size_t b = 0; b < n; ++b) {
    const double red = primaries[b], blue = primaries[n + b];
    basis[b] = {red, 1.0 - red - blue, blue};
  }
  return basis;
}

std::vector<double> band_spectrum(const BandBasis& basis, const LinearSrgb& color) {
  std::vector<double> spectrum;
  for (const auto& primaries : basis) {
    double value = 0.0;
    for (std::size_t c = 0; c < 3; ++c) value += color[c] * primaries[c];
    spectrum.push_back(value);
  }
  return spectrum;
}

}  // namespace lamina
