// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/blurs/gaussian_blurs.h"
#include "lamina/solve/scattering/heterogeneous/blurs/texel_basis.h"

namespace lamina {

/// An operator with a profile of its own at each texel where light comes out: the weights of the
/// scales are sums of the functions of a basis.
template <class T>
struct MappedOperatorOf {
  std::size_t terms = 0;   ///< functions of the basis, from the first on; 0: no operator
  std::vector<T> weights;  ///< [term][scale]
  std::vector<T> totals;   ///< [term]: sums over the scales
};
using MappedOperator = MappedOperatorOf<float>;

template <class T>
using MappedOperators = std::span<const MappedOperatorOf<T>* const>;

/// Applies several operators to a plane: operator o gives at texel x
///
///     sum over scales and terms of weights_o[term][scale] basis_term(x) (blur_scale input)(x).
///
/// @param basis  of the pyramid's size, as the input.
/// @return       [operator].
template <class T>
[[nodiscard]] std::vector<PlaneOf<T>> apply_operators(
    const BlurPyramid& pyramid, const PlaneOf<T>& input,
    const std::type_identity_t<TexelBasisOf<T>>& basis,
    std::type_identity_t<MappedOperators<T>> operators);

/// Applies operators, with the derivative of each by the coordinate of the texel where light comes
/// out; empty where it is 0.
///
/// @param basis  without modes
template <class T>
[[nodiscard]] std::vector<PlaneAndSlope<T>> apply_operators_and_slopes(
    const BlurPyramid& pyramid, const PlaneOf<T>& input,
    const std::type_identity_t<TexelBasisOf<T>>& basis,
    std::type_identity_t<MappedOperators<T>> operators);

/// The transpose: where apply_operators brings light of a texel to others, this brings what is
/// there to the texel, summed over the operators,
///
///     sum over o, scales and terms of blur_scale (weights_o[term][scale] basis_term input_o)(x).
///
/// One set of blurs for all operators. <y, apply_operators(x)> = <apply_transposed(y), x> but for
/// rounding.
///
/// @param inputs  [operator], at least one.
template <class T>
[[nodiscard]] PlaneOf<T> apply_transposed(const BlurPyramid& pyramid,
                                          const std::vector<PlaneOf<T>>& inputs,
                                          const std::type_identity_t<TexelBasisOf<T>>& basis,
                                          std::type_identity_t<MappedOperators<T>> operators);

}  // namespace lamina
