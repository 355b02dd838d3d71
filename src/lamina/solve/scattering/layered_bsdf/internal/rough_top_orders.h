// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/solve/scattering/layered_bsdf/higher_orders.h"
#include "lamina/solve/scattering/layered_bsdf/internal/rough_top.h"

namespace lamina::detail {

/// HigherOrders of a stack under its rough top, for light from above: what adding-doubling has and
/// volume_flux has not. `surface` of the beams given to higher_orders_bsdf is
/// FacetBeams::reflected.
[[nodiscard]] HigherOrders make_higher_orders(const LayerStack& stack, const RoughTop& top,
                                              double accuracy = 1e-4);

}  // namespace lamina::detail
