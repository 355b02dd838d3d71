// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

namespace lamina {

/// Numbers on a grid of texels, row by row: floats, or doubles where gradients are to have all
/// their digits.
template <class T>
struct PlaneOf {
  int width = 0, height = 0;
  std::vector<T> values;  ///< [y][x]
};
using Plane = PlaneOf<float>;

template <class T = float>
[[nodiscard]] PlaneOf<T> make_plane(int width, int height, std::type_identity_t<T> value = T{}) {
  return {
      width, height,
      std::vector<T>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value)};
}

/// Blurs of a plane by Gaussians of doubling width, whose cost per texel does not grow with the
/// width: wide ones run on grids that are coarser by powers of two, or nearly so where a side is
/// odd. Outside, the plane goes on as its mirror image.
///
/// On each grid the plane is blurred from one width to the next by exp(t (cosh d - 1)), the
/// discrete Gaussian: positive, with taps e^-t I_n(t) and exactly the variance t. Steps to coarser
/// grids and back weight by 1 3 3 1 (by GridStep where a side is odd), one the other's transpose.
/// Each blur keeps the light and leaves uniform light uniform. It is its own adjoint, but for waves
/// that are too short for a coarser grid: of white noise those are 1e-3.
///
/// Source: [Lindeberg1990] for the discrete Gaussian.
struct BlurPyramid {
  int width, height;  ///< of the plane
  int levels;         ///< coarser grids, each of half the width and height, rounded up
  /// [scale] in texel²: 0 and doubling, six on the finest grid, two on each coarser one; and
  /// infinity, the mean of the plane.
  std::vector<double> variances;
};

inline constexpr std::size_t finest_scales = 6;

/// The smallest pyramid that holds a variance [texel²], as far as the plane is not smaller than the
/// Gaussian.
[[nodiscard]] BlurPyramid make_blur_pyramid(int width, int height, double largest_variance);

/// A matrix, [variance][scale]: each Gaussian as the sum of scales that comes next to it, for
/// frequencies that the grid has. Largest error of a sharp edge's blur: .003 of its height, near a
/// variance of 8 texel², and .01 where sides are odd; what is narrower than a texel is that of a
/// Gaussian on the grid.
///
/// @param variances  [texel²], >= 0.
[[nodiscard]] std::vector<double> scales_of_gaussians(const BlurPyramid& pyramid,
                                                      std::span<const double> variances);

/// How the scales of one Gaussian change with its variance [1/texel²], [scale].
[[nodiscard]] std::vector<double> scale_slopes(const BlurPyramid& pyramid, double variance);

namespace detail {

/// Transfer of each scale at a spatial frequency [1/texel].
using ScaleTransfers = std::function<std::vector<double>(double k)>;

/// A matrix, [variance][scale], by least squares over frequencies from `lowest` times pi to pi.
[[nodiscard]] std::vector<double> fit_scales(std::span<const double> variances, double lowest,
                                             std::size_t scale_count,
                                             const ScaleTransfers& transfers);

}  // namespace detail

}  // namespace lamina
