// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/base/core/progress.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/solve/reflectance/cubic_table.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::detail {

/// Reflectance and transmittance of leaves by their absorption and structure, on a regular grid of
/// their logarithms with cubics between: LeafTotalsTable for pixels, ten times as quick or more,
/// within 2e-4 of it (tests).
class LeafLight {
 public:
  /// @param leaf             for its palisade share
  /// @param most_absorption  optical thickness up to which the table reaches, > 0
  LeafLight(const LeafParameters& leaf, double most_absorption, const Incidence& incidence,
            const Progress& progress);

  struct Value {
    double reflectance, transmittance;
    std::array<double, 2> by_absorption, by_structure;  ///< of reflectance and transmittance
  };

  /// Value at a place. Places out of the range count as its nearest place.
  [[nodiscard]] Value at(double absorption, double structure) const;

  static constexpr double least_structure = 0.3, most_structure = 10.0;

 private:
  CubicTable<2> table_;  ///< of reflectance and transmittance
};

}  // namespace lamina::detail
