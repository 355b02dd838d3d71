// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {

/// Light that a stack scatters more than once, by the angle it comes from: the term Lm of
/// [HanrahanKrueger1993] Eq. 15, for one band.
///
/// The print adds a constant to the radiance. Here the size of the term follows the angle of
/// incidence, so that all light that leaves on a side is what adding-doubling says, and by
/// reciprocity it follows the angle of exit too: f = M(mu_i) M(mu_o) / (pi mean M).
struct HigherOrders {
  static constexpr int angles = 17;
  using Row = std::array<double, angles>;

  /// Flux over what the boundary that it enters by lets through, at the cosines
  /// (i / (angles - 1))^2 outside.
  Row above{}, below{};                       ///< back to the side that it came from
  Row down{}, up{};                           ///< through; [angle of incidence]
  Row reflected{}, transmitted{};             ///< light of all orders from above, for comparison
  double mean_above = 0.0, mean_below = 0.0;  ///< for diffuse light; boundary included
  double mean_through = 0.0;     ///< times the square of the index that it leaves into, either way
  double estimated_error = 0.0;  ///< largest difference of a flux between the last two grids
};

/// @param accuracy  asked of each flux, absolute.
/// @throws InvalidInput if a boundary below the top is rough. A rough top is taken as a smooth one.
[[nodiscard]] HigherOrders make_higher_orders(const LayerStack& stack, double accuracy = 1e-4);

/// Radiance leaving along `out` per irradiance from `in` [1/sr] by the higher orders; beams of the
/// same stack. Reciprocal as first_order_bsdf.
[[nodiscard]] double higher_orders_bsdf(const HigherOrders& orders, const StackBeam<double>& in,
                                        const StackBeam<double>& out);

}  // namespace lamina
