// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/blurs/gaussian_blurs.h"
#include "lamina/scattering/heterogeneous/blurs/texel_basis.h"

namespace lamina {

/// An operator with a profile of its own at each texel where light comes out: the weights of the
/// scales are sums of the functions of a basis.
struct MappedOperator {
  std::size_t terms = 0;       ///< functions of the basis, from the first on; 0: no operator
  std::vector<float> weights;  ///< [term][scale]
  std::vector<float> totals;   ///< [term]: sums over the scales
};

/// What several operators make of a plane: operator o gives at texel x
///
///     sum over scales and terms of weights_o[term][scale] basis_term(x) (blur_scale input)(x).
///
/// @param basis  of the pyramid's size, as the input.
/// @return       [operator].
[[nodiscard]] std::vector<Plane> apply_operators(const BlurPyramid& pyramid, const Plane& input,
                                                 const TexelBasis& basis,
                                                 std::span<const MappedOperator* const> operators);

}  // namespace lamina
