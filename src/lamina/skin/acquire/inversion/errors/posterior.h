// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lamina/base/core/dense_matrix.h"
#include "lamina/skin/acquire/inversion/steps/band_blocks.h"

namespace lamina::detail {

/// One draw from the Gaussian about a solution whose inverse covariance is the matrix of the
/// Gauss-Newton steps.
struct PosteriorSample {
  TexelMaps off;     ///< from the solution, [number]
  TexelMaps pushed;  ///< what the noise of the images does to the gradient, [number]: its product
                     ///< with `off` is about how many texels the images tell, not smoothness
};

/// Draws by noise of data, smoothness and prior: matrix off = J^T noise + ..., whose covariance is
/// that of the matrix; so each draw is one solution by conjugate gradients.
///
/// @param objective  linearized
/// @param index      of the draw
///
/// Source: [PapandreouYuille2010].
[[nodiscard]] PosteriorSample draw_posterior(const PatchObjective& objective,
                                             const BandBlocks& blocks, std::uint64_t seed,
                                             std::uint64_t index,
                                             const std::function<bool()>& must_end);

/// Standard deviations of coordinates, [number][texel], and their mean correlation.
struct PosteriorErrors {
  TexelMaps deviations;
  DenseMatrix correlation;
};

/// From draws: the shape of the variance is that of the blocks' inverse, its size in each
/// neighborhood that of the draws. Levels of whole images, which nothing smooths, add to it.
///
/// @param level_error  relative, of each image, that all its texels share
[[nodiscard]] PosteriorErrors posterior_errors(const PatchObjective& objective,
                                               const BandBlocks& blocks,
                                               const std::vector<TexelMaps>& draws,
                                               double level_error);

}  // namespace lamina::detail
