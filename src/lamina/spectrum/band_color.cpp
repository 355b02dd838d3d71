// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/spectrum/band_color.h"

#include <Eigen/Dense>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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
MatrixXd estimate_weights(std::span<const double> bands, const MatrixXd& response) {
  const Index n = static_cast<Index>(bands.size());
  const auto band = [&](Index i) { return bands[static_cast<std::size_t>(i)]; };
  // Ordinary kriging: correlations between bands, bordered by the condition on the sum.
  MatrixXd system = MatrixXd::Ones(n + 1, n + 1);
  system(n, n) = 0.0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) system(i, j) = correlation(band(i), band(j));
  const auto table = color_matching_table();
  MatrixXd to_table = MatrixXd::Ones(n + 1, static_cast<Index>(table.size()));
  for (Index i = 0; i < n; ++i)
    for (std::size_t row = 0; row < table.size(); ++row)
      to_table(i, static_cast<Index>(row)) = correlation(band(i), table[row].wavelength);
  const MatrixXd right = to_table * response;
  return system.fullPivLu().solve(right).topRows(n);
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
VectorXd smooth_primaries(std::span<const double> bands, const MatrixXd& weights) {
  const Index n = weights.cols();
  const double mean_step = (bands.back() - bands.front()) / static_cast<double>(n - 1);
  MatrixXd slopes = MatrixXd::Zero(n - 1, n);
  for (Index i = 0; i + 1 < n; ++i) {
    const std::size_t b = static_cast<std::size_t>(i);
    const double scale = std::sqrt(mean_step / (bands[b + 1] - bands[b]));
    slopes(i, i) = -scale;
    slopes(i, i + 1) = scale;
  }
  const MatrixXd roughness = slopes.transpose() * slopes + 1e-6 * MatrixXd::Identity(n, n);

  VectorXd x = VectorXd::Zero(2 * n);
  std::vector<bool> is_negative(static_cast<std::size_t>(3 * n), false);
  for (int round = 0; round < 60; ++round) {
    // Quadratic in x = (red, blue): x' H x - 2 f' x, where green = 1 - red - blue.
    constexpr double penalty = 1e3;  // of the square of a negative value, against that of a slope
    const auto weighted = [&](Index primary) {
      MatrixXd quadratic = roughness;
      for (Index i = 0; i < n; ++i)
        if (is_negative[static_cast<std::size_t>(primary * n + i)]) quadratic(i, i) += penalty;
      return quadratic;
    };
    const MatrixXd red = weighted(0), blue = weighted(1), green = weighted(2);
    MatrixXd system = MatrixXd::Zero(2 * n + 6, 2 * n + 6);
    VectorXd right = VectorXd::Zero(2 * n + 6);
    system.block(0, 0, n, n) = red + green;
    system.block(n, n, n, n) = blue + green;
    system.block(0, n, n, n) = system.block(n, 0, n, n) = green;
    right.head(n) = right.segment(n, n) = green * VectorXd::Ones(n);
    for (Index primary = 0; primary < 2; ++primary) {
      system.block(2 * n + 3 * primary, primary * n, 3, n) = weights;
      system.block(primary * n, 2 * n + 3 * primary, n, 3) = weights.transpose();
    }
    right(2 * n) = right(2 * n + 5) = 1.0;  // red is (1, 0, 0), blue (0, 0, 1)
    x = system.fullPivLu().solve(right).head(2 * n);

    bool is_settled = true;
    for (Index i = 0; i < n; ++i) {
      const std::array<double, 3> values = {x(i), x(n + i), 1.0 - x(i) - x(n + i)};
      for (Index primary = 0; primary < 3; ++primary) {
        const bool now = values[static_cast<std::size_t>(primary)] < 0.0;
        auto before = is_negative[static_cast<std::size_t>(primary * n + i)];
        is_settled = is_settled && now == before;
        before = now;
      }
    }
    if (is_settled) break;
  }
  return x;
}

}  // namespace

BandWeights make_band_weights(const BandSet& bands, Illuminant illuminant) {
  if (bands.is_rgb()) return identity;
  const Xyz white = white_point(illuminant);
  const Matrix3 to_srgb = xyz_to_linear_srgb() * bradford_adaptation(white, srgb_white());
  const auto table = color_matching_table();
  MatrixXd response(static_cast<Index>(table.size()), 3);  // of linear sRGB at each wavelength
  double luminance = 0.0;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const double power = illuminant_power(illuminant, table[row].wavelength);
    luminance += power * table[row].y;
    const std::array<double, 3> rgb = to_srgb * Xyz{table[row].x, table[row].y, table[row].z};
    for (Index c = 0; c < 3; ++c)
      response(static_cast<Index>(row), c) = power * rgb[static_cast<std::size_t>(c)];
  }
  response /= luminance;
  const MatrixXd estimated = estimate_weights(bands.wavelengths(), response);
  BandWeights weights(bands.size());
  for (std::size_t b = 0; b < weights.size(); ++b)
    for (std::size_t c = 0; c < 3; ++c)
      weights[b][c] = estimated(static_cast<Index>(b), static_cast<Index>(c));
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

BandBasis make_band_basis(const BandSet& bands, const BandWeights& weights) {
  if (bands.is_rgb()) return identity;
  const Index n = static_cast<Index>(bands.size());
  MatrixXd matrix(3, n);
  for (Index b = 0; b < n; ++b)
    for (Index c = 0; c < 3; ++c)
      matrix(c, b) = weights[static_cast<std::size_t>(b)][static_cast<std::size_t>(c)];
  // Colours that the bands cannot show would take spectra far below 0 and above 1.
  constexpr double least_distinction = 0.02;
  const VectorXd strengths = Eigen::JacobiSVD<MatrixXd>(matrix).singularValues();
  if (n < 3 || strengths(2) < least_distinction * strengths(0)) {
    const std::array<double, 3> luminance = linear_srgb_to_xyz()[1];
    return BandBasis(bands.size(), luminance);
  }
  const VectorXd primaries = smooth_primaries(bands.wavelengths(), matrix);
  BandBasis basis(bands.size());
  for (Index b = 0; b < n; ++b) {
    const double red = primaries(b), blue = primaries(n + b);
    basis[static_cast<std::size_t>(b)] = {red, 1.0 - red - blue, blue};
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
