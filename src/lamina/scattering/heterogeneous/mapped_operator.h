// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/scattering/heterogeneous/gaussian_blurs.h"
#include "lamina/scattering/heterogeneous/gaussian_tables.h"

namespace lamina {

/// Absorptions that a map holds [1/mm]. What lies outside counts as the nearer end.
struct AbsorptionRange {
  double lowest, highest;
};

/// The range of a map, widened to hold no less than the table's rows do and no more.
[[nodiscard]] AbsorptionRange absorption_range(const Plane& sigma_a, const GaussianTableGrid& grid);

/// Place of each absorption in the range: its square root, -1 at the lowest and 1 at the highest.
/// (Diffusion depends on the root of absorption: so polynomials of low degree do.)
[[nodiscard]] Plane absorption_coordinate(const Plane& sigma_a, const AbsorptionRange& range);

/// A table's operator over a range of absorptions, its weights as polynomials of the coordinate: of
/// the least degree that keeps the error of the transform below `tolerance` times the largest total
/// in the range.
///
/// @param scales  of the table's Gaussians, as scales_of_gaussians gives them.
[[nodiscard]] MappedOperator make_mapped_operator(const StackTables& tables,
                                                  const GaussianTable& table,
                                                  const AbsorptionRange& range,
                                                  std::span<const double> scales,
                                                  double tolerance = 5e-5);

}  // namespace lamina
