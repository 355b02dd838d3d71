// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lamina/layers/optics/rough/rough_surface_scattering.h"

namespace lamina::detail {

/// Counts of light by the cell in which it leaves. Tallies of parts of the work add up.
class ScatteringTally {
 public:
  explicit ScatteringTally(ExitCells cells);

  /// Light that starts with the given weight, relative to its arriving flux.
  void start(double weight) { started_ += weight, ++rays_; }

  /// Counts light that leaves to wo after `order` facets; order 0 gives it up.
  void leave(const Vec3& wo, int order, double weight);

  [[nodiscard]] std::int64_t rays() const { return rays_; }

 private:
  friend RoughSurfaceScattering scattering_of(std::span<const ScatteringTally> parts);

  struct Side {
    std::vector<double> all, all2, single;  ///< weights, their squares, weights of order 1 [cell]
    double total = 0.0, single_total = 0.0;
  };
  ExitCells cells_;
  std::array<Side, 2> sides_;  ///< reflected, transmitted
  double started_ = 0.0, given_up_ = 0.0;
  std::int64_t rays_ = 0;
};

/// The mean over parts of equal size; the scatter between them gives the errors of the totals.
[[nodiscard]] RoughSurfaceScattering scattering_of(std::span<const ScatteringTally> parts);

/// Integral of cos(theta) over a cell, both of its halves [sr].
[[nodiscard]] double projected_solid_angle(ExitCells cells, int theta);

}  // namespace lamina::detail
