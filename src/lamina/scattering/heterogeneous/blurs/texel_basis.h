// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/scattering/heterogeneous/blurs/gaussian_blurs.h"

namespace lamina {

/// Functions of the texel, of which the weights of operators are sums: the powers of a coordinate
/// in [-1, 1], or, where there are any, modes.
struct TexelBasis {
  Plane coordinate;
  std::vector<Plane> modes = {};
};

}  // namespace lamina
