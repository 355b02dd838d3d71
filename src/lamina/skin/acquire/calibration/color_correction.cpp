// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/calibration/color_correction.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/skin/acquire/calibration/internal/channel_values.h"

namespace lamina {
namespace {

using Triple = std::array<double, 3>;

/// R of R^T R = the metric of CIEDE2000 about a color: |R d| is the difference that a small change
/// d of linear sRGB makes.
Matrix3 difference_root(const LinearSrgb& color) {
  const double step = 0.01 * (0.01 + *std::ranges::max_element(color));
  const Lab here = lab(color);
  const auto square = [&](const Triple& d) {
    const double forth =
        color_difference(here, lab(LinearSrgb{color[0] + d[0], color[1] + d[1], color[2] + d[2]}));
    const double back =
        color_difference(here, lab(LinearSrgb{color[0] - d[0], color[1] - d[1], color[2] - d[2]}));
    return 0.5 * (forth * forth + back * back) / (step * step);
  };
  const auto along = [&](std::size_t a) {
    Triple d{};
    d[a] = step;
    return d;
  };
  Matrix3 metric{};
  for (std::size_t a = 0; a < 3; ++a) metric[a][a] = square(along(a));
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      Triple both = along(a);
      both[b] = step;
      metric[a][b] = metric[b][a] = 0.5 * (square(both) - metric[a][a] - metric[b][b]);
    }
  // Cholesky; the metric is positive but for rounding.
  const double least = 1e-9 * (metric[0][0] + metric[1][1] + metric[2][2]);
  Matrix3 root{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = a; b < 3; ++b) {
      double left = metric[a][b];
      for (std::size_t k = 0; k < a; ++k) left -= root[k][a] * root[k][b];
      root[a][b] = a == b ? std::sqrt(std::max(left, least)) : left / root[a][a];
    }
  return root;
}

/// One sample's three rows of the least squares.
struct SampleRows {
  std::array<std::array<double, 9>, 3> rows{};
  Triple wanted{};
};

SampleRows rows_of(const ColorSample& sample) {
  const Matrix3 root = difference_root(sample.reference);
  SampleRows result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) result.rows[r][3 * k + c] = root[r][k] * sample.camera[c];
      result.wanted[r] += root[r][k] * sample.reference[k];
    }
  return result;
}

constexpr std::size_t no_sample = static_cast<std::size_t>(-1);

Matrix3 fitted_matrix(std::span<const SampleRows> samples, std::size_t left_out) {
  const std::size_t count = samples.size() - (left_out == no_sample ? 0 : 1);
  DenseMatrix a(3 * count, 9), b(3 * count, 1);
  std::size_t row = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == left_out) continue;
    for (std::size_t r = 0; r < 3; ++r, ++row) {
      std::ranges::copy(samples[i].rows[r], a.row(row).begin());
      b(row, 0) = samples[i].wanted[r];
    }
  }
  const DenseMatrix x = solve_least_squares(a, b);
  Matrix3 matrix{};
  for (std::size_t i = 0; i < 9; ++i) matrix[i / 3][i % 3] = x(i, 0);
  return matrix;
}

double difference_of(const Matrix3& matrix, const ColorSample& sample) {
  return color_difference(lab(LinearSrgb(matrix * sample.camera)), lab(sample.reference));
}

DenseMatrix matrix_covariance(std::span<const SampleRows> samples, const Matrix3& matrix) {
  DenseMatrix squares(9, 9), one(9, 9);
  double residuals = 0.0;
  for (const SampleRows& sample : samples)
    for (std::size_t r = 0; r < 3; ++r) {
      double residual = sample.wanted[r];
      for (std::size_t i = 0; i < 9; ++i) {
        residual -= sample.rows[r][i] * matrix[i / 3][i % 3];
        for (std::size_t j = 0; j < 9; ++j) squares(i, j) += sample.rows[r][i] * sample.rows[r][j];
      }
      residuals += residual * residual;
    }
  for (std::size_t i = 0; i < 9; ++i) one(i, i) = 1.0;
  DenseMatrix covariance = solve_linear(squares, one);
  const double scale = residuals / static_cast<double>(3 * samples.size() - 9);
  for (double& value : covariance.values) value *= scale;
  return covariance;
}

void check_samples(std::span<const ColorSample> samples) {
  if (samples.size() < 6)
    throw InvalidInput("color correction: at least 6 colors are required, but there are " +
                       std::to_string(samples.size()));
  DenseMatrix camera(samples.size(), 3);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      camera(i, c) = samples[i].camera[c];
      if (!std::isfinite(samples[i].camera[c]) || !std::isfinite(samples[i].reference[c]))
        throw InvalidInput("color correction: color " + std::to_string(i + 1) + " must be finite");
    }
  const std::vector<double> sizes = singular_values(camera);
  if (!(sizes[2] > 1e-4 * sizes[0]))
    throw InvalidInput(
        "color correction: the camera's colors must differ in hue, but are nearly alike");
}

}  // namespace

ColorCorrection fit_color_correction(std::span<const ColorSample> samples) {
  check_samples(samples);
  std::vector<SampleRows> rows;
  for (const ColorSample& sample : samples) rows.push_back(rows_of(sample));
  ColorCorrection result{.matrix = fitted_matrix(rows, no_sample)};
  result.covariance = matrix_covariance(rows, result.matrix);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    result.errors.push_back(difference_of(result.matrix, samples[i]));
    result.left_out_errors.push_back(difference_of(fitted_matrix(rows, i), samples[i]));
    result.mean_error += result.errors[i] / static_cast<double>(samples.size());
    result.mean_left_out_error += result.left_out_errors[i] / static_cast<double>(samples.size());
  }
  result.largest_left_out_error = *std::ranges::max_element(result.left_out_errors);
  return result;
}

Matrix3 correction_covariance(const ColorCorrection& correction,
                              const std::array<double, 3>& camera) {
  Matrix3 covariance{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l)
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          covariance[k][l] += camera[a] * camera[b] * correction.covariance(3 * k + a, 3 * l + b);
  return covariance;
}

CorrectedImage corrected_colors(const Image& image, const Image& deviation, const Matrix3& matrix) {
  const std::vector<std::string> names = {"R", "G", "B"};
  CorrectedImage result{select_channels(image, names), select_channels(deviation, names)};
  require_like(result.deviation, result.color, "color correction: the image of deviations");
  constexpr std::size_t chunk = 4096;
  const std::size_t numbers = result.color.pixels.size();
  parallel_for((numbers / 3 + chunk - 1) / chunk, [&](std::size_t part) {
    for (std::size_t i = 3 * chunk * part; i < std::min(numbers, 3 * chunk * (part + 1)); i += 3) {
      Triple color{}, variance{};
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
          const auto error = static_cast<double>(result.deviation.pixels[i + c]);
          color[k] += matrix[k][c] * static_cast<double>(result.color.pixels[i + c]);
          variance[k] += matrix[k][c] * matrix[k][c] * error * error;
        }
      for (std::size_t k = 0; k < 3; ++k) {
        result.color.pixels[i + k] = static_cast<float>(color[k]);
        result.deviation.pixels[i + k] = static_cast<float>(std::sqrt(variance[k]));
      }
    }
  });
  return result;
}

}  // namespace lamina
