// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/internal/operator_totals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "lamina/scattering/adding_doubling/adding_doubling.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/heterogeneous/internal/chebyshev_box.h"
#include "lamina/scattering/profile/layer_response.h"

namespace lamina::detail {
namespace {

double ior_over(const MappedStack& stack, std::size_t layer) {
  return layer == 0 ? stack.ior_above : stack.layers[layer - 1].ior;
}

double ior_under(const MappedStack& stack, std::size_t layer) {
  return layer + 1 == stack.layers.size() ? stack.ior_below : stack.layers[layer + 1].ior;
}

/// Where light comes from.
enum class From {
  neighbor,        ///< evenly
  outside,         ///< normally
  outside_evenly,  ///< from all directions
};

/// What light does that arrives on a stack and gets through its first boundary.
struct Entered {
  double reflection, transmission;
};

/// Light from outside is counted once it has entered; light from a neighbouring layer, whose index
/// is nearly the same, when it arrives.
Entered solve(const LayerStack& stack, From from) {
  const SlabTotals totals = adding_doubling(stack, {.is_diffuse = from != From::outside}).totals;
  if (from == From::neighbor)
    return {totals.specular_reflectance + totals.diffuse_reflectance, totals.transmittance};
  const double entered = 1.0 - totals.specular_reflectance;
  return {totals.diffuse_reflectance / entered, totals.transmittance / entered};
}

LayerResponse solve_layer(const MappedStack& stack, std::size_t i, const LayerState& state,
                          From outside) {
  Layer layer = solid_layer(stack, i, state);
  const double over = ior_over(stack, i), under = ior_under(stack, i);
  const Entered above = solve(LayerStack({layer}, over, under), i == 0 ? outside : From::neighbor);
  if (std::isinf(layer.thickness)) return {above.reflection, 0.0, 0.0, 0.0};
  const bool is_last = i + 1 == stack.layers.size() && stack.ground_reflectance == 0.0;
  const Interface top = std::exchange(layer.top, {});
  const Entered below =
      solve(LayerStack({layer}, under, over, {.top = top}), is_last ? outside : From::neighbor);
  return {above.reflection, above.transmission, below.reflection, below.transmission};
}

/// The last layer such that the whole stack reflects and transmits as `whole`.
LayerResponse last_of(const LayerResponse& cover, const Entered& whole, LayerResponse last) {
  const double through = std::max(0.0, whole.reflection - cover.reflection_above);
  last.reflection_above = through / (cover.transmission_down * cover.transmission_up +
                                     through * cover.reflection_below);
  if (last.transmission_down > 0.0)
    last.transmission_down = std::max(0.0, whole.transmission) *
                             (1.0 - cover.reflection_below * last.reflection_above) /
                             cover.transmission_down;
  return last;
}

}  // namespace

Layer solid_layer(const MappedStack& stack, std::size_t layer, const LayerState& state) {
  return {
      .medium = {.sigma_a = state.sigma_a,
                 .sigma_s = state.sigma_s,
                 .g = state.g,
                 .ior = stack.layers[layer].ior},
      .thickness = state.thickness,
      .top = {.roughness = layer == 0 ? state.roughness : 0.0, .distribution = stack.distribution}};
}

std::vector<LayerTotals> transfer_operator_totals(const MappedStack& stack,
                                                  std::span<const StateLattice> lattices,
                                                  std::span<const LayerState> reference,
                                                  bool is_lit_evenly) {
  assert(reference.size() == stack.layers.size() && lattices.size() == stack.layers.size());
  const std::size_t size = stack.layers.size();
  const From outside = is_lit_evenly ? From::outside_evenly : From::outside;

  // The layers above the last one, at their reference states, or with so much less absorption that
  // enough light comes back through them to tell how the last one reflects.
  constexpr double enough = 1e-3;
  LayerResponse cover;
  std::vector<Layer> all;
  for (double share = 1.0; size > 1 && all.empty(); share *= 0.5) {
    cover = LayerResponse{};
    for (std::size_t i = 0; i + 1 < size; ++i) {
      LayerState state = reference[i];
      state.sigma_a *= share;
      cover = stacked(cover, solve_layer(stack, i, state, outside));
      all.push_back(solid_layer(stack, i, state));
    }
    if (cover.transmission_down * cover.transmission_up < enough && share > 1e-3) all.clear();
  }

  std::vector<LayerTotals> totals(size);
  for (std::size_t i = 0; i < size; ++i) {
    const ChebyshevBox box(lattices[i], 4.0, 28);
    LayerTotals at_points;
    for (std::size_t point = 0; point < box.size(); ++point) {
      const LayerState state = box.state(point);
      const bool is_on_others = size > 1 && i + 1 == size;
      LayerResponse r{0.0, 0.0, 0.0, 0.0};
      if (!is_on_others || std::isfinite(state.thickness))
        r = solve_layer(stack, i, state, outside);
      if (is_on_others) {
        std::vector<Layer> layers = all;
        layers.push_back(solid_layer(stack, i, state));
        r = last_of(cover, solve(LayerStack(layers, stack.ior_above, stack.ior_below), outside), r);
      }
      at_points[0].push_back(r.reflection_above), at_points[1].push_back(r.transmission_down);
      at_points[2].push_back(r.reflection_below), at_points[3].push_back(r.transmission_up);
    }
    for (std::size_t node = 0; node < node_count(lattices[i]); ++node) {
      const std::vector<double> shares = box.shares(node_state(lattices[i], node));
      for (std::size_t which = 0; which < 4; ++which) {
        double sum = 0.0;
        for (std::size_t p = 0; p < shares.size(); ++p) sum += shares[p] * at_points[which][p];
        totals[i][which].push_back(std::max(0.0, sum));
      }
    }
  }
  return totals;
}

std::pair<double, double> boundary_reflectances(const MappedStack& stack, std::size_t layer,
                                                double roughness) {
  const double ior = stack.layers[layer].ior;
  const Interface top{.roughness = layer == 0 ? roughness : 0.0,
                      .distribution = stack.distribution};
  return {diffuse_reflectance_inside(top, ior, ior_over(stack, layer), DiffuseFresnel::exact),
          diffuse_reflectance_inside({}, ior, ior_under(stack, layer), DiffuseFresnel::exact)};
}

}  // namespace lamina::detail
