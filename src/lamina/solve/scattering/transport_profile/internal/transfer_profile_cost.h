// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina::detail {

/// Cost of the coarsest profile of some stacks, all bands: finer ones take more.
struct SolutionCost {
  double seconds = 0.0;  ///< of one processor core with AVX-512, within a factor 2
  double mebibytes = 0.0;
};

/// @param nodes, modes, frequencies  of that profile
[[nodiscard]] SolutionCost solution_cost(std::span<const LayerStack> stacks, int nodes, int modes,
                                         int frequencies);

/// @throws InvalidInput with the estimate if that is more than 10 minutes or 2 GiB.
void require_affordable(const SolutionCost& cost);

}  // namespace lamina::detail
