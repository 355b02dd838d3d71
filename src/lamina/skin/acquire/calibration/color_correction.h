// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/base/image/image.h"
#include "lamina/base/spectrum/color.h"

namespace lamina {

/// A color as a camera saw it, and as it is.
struct ColorSample {
  std::array<double, 3> camera{};  ///< linear R, G, B, less the dark
  LinearSrgb reference{};
};

/// A matrix from a camera's colors to linear sRGB, with what is known of its errors.
struct ColorCorrection {
  Matrix3 matrix{};
  /// Covariance of the entries of the matrix, row by row, [9][9]: by the residuals of the fit.
  DenseMatrix covariance;
  std::vector<double> errors;           ///< CIEDE2000 of each sample
  std::vector<double> left_out_errors;  ///< the same, each by a fit of all others: what to expect
                                        ///< of other colors of the kind
  double mean_error = 0.0, mean_left_out_error = 0.0, largest_left_out_error = 0.0;
};

/// The matrix of least squares, each sample's error in the metric that CIEDE2000 has at its
/// reference, so that it counts as an eye would see it. It sets the exposure, too.
///
/// A matrix is exact only for a camera whose curves are sums of an eye's: others miss by a
/// CIEDE2000 of 1 to 3 for charts, and skin, whose spectra have bands, by about as much.
///
/// @throws InvalidInput unless there are 6 samples or more, all finite, whose camera colors are not
///         all in a plane.
///
/// Source: [Finlayson2015] for the linear fit; [Sharma2005] for the metric.
[[nodiscard]] ColorCorrection fit_color_correction(std::span<const ColorSample> samples);

/// The covariance of a corrected color by the errors of the matrix: the same error for all pixels
/// of a color, not noise.
[[nodiscard]] Matrix3 correction_covariance(const ColorCorrection& correction,
                                            const std::array<double, 3>& camera);

struct CorrectedImage {
  Image color;      ///< linear "R", "G", "B"; may lie outside of [0, 1]
  Image deviation;  ///< by noise alone
};

/// @param image      linear, with channels "R", "G", "B"
/// @param deviation  standard deviations of its pixels, which do not go together
/// @throws InvalidInput if there are no such channels, or images of different sizes.
[[nodiscard]] CorrectedImage corrected_colors(const Image& image, const Image& deviation,
                                              const Matrix3& matrix);

}  // namespace lamina
