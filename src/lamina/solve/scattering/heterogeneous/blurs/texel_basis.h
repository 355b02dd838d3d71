// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"

namespace lamina {

/// Functions of the texel, of which the weights of operators are sums: the powers of a coordinate
/// in [-1, 1], or, where there are any, modes.
template <class T>
struct TexelBasisOf {
  PlaneOf<T> coordinate;
  std::vector<PlaneOf<T>> modes = {};
};
using TexelBasis = TexelBasisOf<float>;

/// Adds to each texel of row y of a sum the value there times the basis' functions by coefficients.
///
/// @param values, sum   as many as a row has texels
/// @param coefficients  [function], of the first ones
template <class T>
void add_times_basis(const TexelBasisOf<T>& basis, int y,
                     std::type_identity_t<std::span<const T>> values,
                     std::type_identity_t<std::span<const T>> coefficients,
                     std::type_identity_t<std::span<T>> sum);

/// A plane times the basis' functions by coefficients.
template <class T>
[[nodiscard]] PlaneOf<T> times_basis(const TexelBasisOf<T>& basis, const PlaneOf<T>& plane,
                                     std::type_identity_t<std::span<const T>> coefficients);

/// Plane, and its derivative by the coordinate.
///
/// @param basis  without modes
template <class T>
struct PlaneAndSlope {
  PlaneOf<T> plane, slope;
};
template <class T>
[[nodiscard]] PlaneAndSlope<T> times_basis_and_slope(
    const TexelBasisOf<T>& basis, const PlaneOf<T>& plane,
    std::type_identity_t<std::span<const T>> coefficients);

}  // namespace lamina
