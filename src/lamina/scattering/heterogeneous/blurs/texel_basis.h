// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/scattering/heterogeneous/blurs/gaussian_blurs.h"

namespace lamina {

/// Functions of the texel, of which the weights of operators are sums: the powers of a coordinate
/// in [-1, 1], or, where there are any, modes.
struct TexelBasis {
  Plane coordinate;
  std::vector<Plane> modes = {};
};

/// Adds to each texel of row y of a sum the value there times the basis' functions by coefficients.
///
/// @param values, sum   as many as a row has texels
/// @param coefficients  [function], of the first ones
void add_times_basis(const TexelBasis& basis, int y, std::span<const float> values,
                     std::span<const float> coefficients, std::span<float> sum);

}  // namespace lamina
