// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/small_matrix.h"
#include "lamina/skin/acquire/inversion/objective/half_grid.h"
#include "lamina/skin/acquire/inversion/objective/patch_objective.h"
#include "lamina/skin/acquire/inversion/texels/skin_at_texel.h"

namespace lamina::detail {

/// A preconditioner for Gauss-Newton steps: the matrix for waves of each octave, with a block for
/// each texel of a grid that is as coarse as they are. In a block each image follows the numbers as
/// if the surroundings were like the texel, times what of such waves light that travels sideways
/// leaves; smoothness counts by the square of the wave number. Vectors are taken apart into octaves
/// by a pyramid of details (a Laplacian pyramid), so that the whole is symmetric and positive; what
/// moves all texels alike has a block of its own.
///
/// What light leaves of waves is found by the change of the images with noise in all numbers.
///
/// Source: the pyramid [BurtAdelson1983]; its use is lamina's own.
class BandBlocks {
 public:
  /// @param objective    linearized; costs one forward equivalent
  /// @param coordinates  there
  /// @param level        light that arrives at each texel, [image], as fit_texel takes it
  BandBlocks(const PatchObjective& objective, const TexelMaps& coordinates, const TexelMaps& level);

  /// About the inverse of the matrix times a vector.
  [[nodiscard]] TexelMaps solve(const TexelMaps& b) const;
  /// About the diagonal of the inverse, [number].
  [[nodiscard]] TexelMaps inverse_diagonal() const;
  /// About what each number moves by, at all texels alike, over the relative error of the level of
  /// each image, [number][image].
  [[nodiscard]] const std::vector<std::vector<double>>& level_shifts() const {
    return level_shifts_;
  }

 private:
  /// How images follow numbers, per deviation: [image * numbers + number][texel].
  struct Octave {
    GridSize size;
    TexelMaps slopes;
    std::vector<float> lower;  ///< [texel][row][column <= row] of Cholesky's triangles of blocks
  };
  /// Shares of waves of an octave that are left: [image * numbers + number].
  [[nodiscard]] std::vector<double> measured_shares(const Octave& octave, const TexelMaps& changes,
                                                    const TexelMaps& noise) const;
  /// @param smoothness  with shares on the octave's grid
  void decompose(Octave& octave, std::size_t number, const std::vector<double>& shares,
                 const PatchObjective& objective,
                 const std::vector<MapSmoothness>& smoothness) const;
  void find_level_shifts(const PatchObjective& objective, const TexelMaps& slopes);

  std::size_t numbers_, images_;
  std::vector<Octave> octaves_;
  std::vector<std::vector<double>> level_shifts_;  ///< [number][image]
  TexelMatrix whole_ = {};  ///< Cholesky's triangle of the same change of all texels
};

}  // namespace lamina::detail
