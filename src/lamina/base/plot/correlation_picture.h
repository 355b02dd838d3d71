// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "lamina/base/core/dense_matrix.h"

namespace lamina {

/// A correlation matrix as SVG: its lower half, a cell with its number for each pair, from blue,
/// −1, by white, 0, to vermilion, 1, with a legend.
/// @param names        of rows and columns
/// @param correlation  as many rows and columns as names, at least one
[[nodiscard]] std::string format_correlations(std::span<const std::string> names,
                                              const DenseMatrix& correlation);

}  // namespace lamina
