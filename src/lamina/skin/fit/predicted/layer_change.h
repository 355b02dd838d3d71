// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/layer_derivatives.h"

namespace lamina::fit_detail {

/// By which what a layer is made of changes, as LayerDerivatives are by it.
struct LayerChange {
  double sigma_a = 0.0, sigma_s = 0.0, g = 0.0, thickness = 0.0;
};

/// From a stack to another, [layer]; none where more than this differs.
[[nodiscard]] std::optional<std::vector<LayerChange>> change_between(const LayerStack& a,
                                                                     const LayerStack& b);

/// Derivative of a total along such a change.
[[nodiscard]] double derivative_along(const std::vector<LayerDerivatives>& derivatives,
                                      const std::vector<LayerChange>& change);

}  // namespace lamina::fit_detail
