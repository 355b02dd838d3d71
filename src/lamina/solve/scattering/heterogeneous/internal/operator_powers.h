// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/texel_operators.h"
#include "lamina/solve/scattering/heterogeneous/tables/operator_modes.h"

namespace lamina::detail {

/// No operator is fitted by more.
inline constexpr std::size_t most_powers = 20;

/// The operator on the scales of a pyramid whose weights at a coordinate x in [-1, 1] are those of
/// Gaussians that `weights_of(x)` gives: polynomials of the least degree that keeps the error of
/// the transform below `tolerance` times the largest total.
///
/// @param scales  of the Gaussians, as scales_of_gaussians gives them
[[nodiscard]] MappedOperator fit_powers(
    const std::function<std::vector<double>(double)>& weights_of,
    const std::vector<double>& variances, std::span<const double> scales, double tolerance);

/// An operator on the scales of a pyramid from weights of Gaussians, [term][gaussian].
[[nodiscard]] MappedOperator on_scales(const ValuesOfRows& terms, std::span<const double> scales);

}  // namespace lamina::detail
