// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/heterogeneous/tables/operator_totals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/heterogeneous/tables/internal/chebyshev_box.h"
#include "lamina/solve/scattering/profile/layer_response.h"

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

/// The reflection of a last layer such that the whole stack reflects so much.
double last_reflection(const LayerResponse& cover, double whole) {
  const double through = std::max(0.0, whole - cover.reflection_above);
  return through /
         (cover.transmission_down * cover.transmission_up + through * cover.reflection_below);
}

/// The transmission of a last layer such that the whole stack transmits so much.
double last_transmission(const LayerResponse& cover, double whole, double last_reflection) {
  return std::max(0.0, whole) * (1.0 - cover.reflection_below * last_reflection) /
         cover.transmission_down;
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

namespace {

/// The layers above one.
struct Cover {
  LayerResponse response;
  std::vector<Layer> layers;
  double share = 1.0;  ///< of their absorption
};

/// They are at their reference states, or with so much less absorption that a part of the light
/// gets through them and back.
///
/// @param at_reference  [layer] responses of the layers above at their reference states
/// @param enough        that part
Cover cover_of(const MappedStack& stack, std::span<const LayerResponse> at_reference,
               std::span<const LayerState> reference, From outside, double enough) {
  Cover cover;
  for (double share = 1.0; cover.layers.empty(); share *= 0.5) {
    cover.response = LayerResponse{};
    cover.share = share;
    for (std::size_t i = 0; i < at_reference.size(); ++i) {
      LayerState state = reference[i];
      state.sigma_a *= share;
      cover.response = stacked(
          cover.response, share == 1.0 ? at_reference[i] : solve_layer(stack, i, state, outside));
      cover.layers.push_back(solid_layer(stack, i, state));
    }
    if (cover.response.transmission_down * cover.response.transmission_up < enough && share > 1e-3)
      cover.layers.clear();
  }
  return cover;
}

/// What a layer is under: its reflection is told by light that comes back through a cover that
/// lets enough of it through, its transmission by light that passes the cover as it is.
struct Covers {
  Cover for_reflection;
  std::optional<Cover> for_transmission;  ///< absent: the same
};

/// A layer alone if it is the first, else such that it and those above it reflect and transmit as
/// they should.
LayerResponse solve_on(const MappedStack& stack, std::size_t i, const LayerState& state,
                       const Covers& covers, From outside) {
  const bool is_finite = std::isfinite(state.thickness);
  LayerResponse r{0.0, 0.0, 0.0, 0.0};
  if (i == 0 || is_finite) r = solve_layer(stack, i, state, outside);
  if (i == 0) return r;
  const auto under = [&](const Cover& cover) {
    std::vector<Layer> layers = cover.layers;
    layers.push_back(solid_layer(stack, i, state));
    return solve(LayerStack(layers, stack.ior_above, ior_under(stack, i)), outside);
  };
  const Cover& cover = covers.for_reflection;
  const Entered whole = under(cover);
  r.reflection_above = last_reflection(cover.response, whole.reflection);
  if (!is_finite) return r;
  r.transmission_down =
      covers.for_transmission
          ? last_transmission(covers.for_transmission->response,
                              under(*covers.for_transmission).transmission, r.reflection_above)
          : last_transmission(cover.response, whole.transmission, r.reflection_above);
  return r;
}

/// The first layer such that the whole stack reflects and transmits as `whole`, with `below` under
/// it.
LayerResponse first_of(const Entered& whole, const LayerResponse& below, LayerResponse first) {
  const double transmitted = stacked(first, below).transmission_down;
  if (transmitted > 1e-6) first.transmission_down *= whole.transmission / transmitted;
  first.reflection_above += whole.reflection - stacked(first, below).reflection_above;
  return first;
}

}  // namespace

std::vector<LayerTotals> transfer_operator_totals(const MappedStack& stack,
                                                  std::span<const StateLattice> lattices,
                                                  std::span<const LayerState> reference,
                                                  bool is_lit_evenly, const Progress& progress) {
  assert(reference.size() == stack.layers.size() && lattices.size() == stack.layers.size());
  const std::size_t size = stack.layers.size();
  const From outside = is_lit_evenly ? From::outside_evenly : From::outside;
  std::vector<ChebyshevBox> boxes;
  std::vector<std::vector<LayerResponse>> at_points(size);
  std::vector<LayerResponse> at_reference;
  for (std::size_t i = 0; i < size; ++i) {
    constexpr double enough = 1e-3;
    Covers covers;
    if (i > 0) {
      covers.for_reflection = cover_of(stack, at_reference, reference, outside, enough);
      if (covers.for_reflection.share < 1.0)
        covers.for_transmission = cover_of(stack, at_reference, reference, outside, 0.0);
    }
    boxes.emplace_back(lattices[i], 4.0, 28);
    for (std::size_t point = 0; point < boxes[i].size(); ++point) {
      at_points[i].push_back(solve_on(stack, i, boxes[i].state(point), covers, outside));
      const double in_layer = static_cast<double>(point + 1) / static_cast<double>(boxes[i].size());
      report_or_throw(progress,
                      (static_cast<double>(i) + in_layer) / static_cast<double>(size + 1));
    }
    at_reference.push_back(solve_on(stack, i, reference[i], covers, outside));
  }
  if (size > 1 && stack.layers[0].states) {
    LayerResponse below;
    std::vector<Layer> layers = {{}};
    for (std::size_t i = 1; i < size; ++i) {
      below = stacked(below, at_reference[i]);
      layers.push_back(solid_layer(stack, i, reference[i]));
    }
    for (std::size_t point = 0; point < boxes[0].size(); ++point) {
      layers[0] = solid_layer(stack, 0, boxes[0].state(point));
      at_points[0][point] =
          first_of(solve(LayerStack(layers, stack.ior_above, stack.ior_below), outside), below,
                   at_points[0][point]);
      report_or_throw(progress, static_cast<double>(size) / static_cast<double>(size + 1));
    }
  }

  std::vector<LayerTotals> totals(size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t node = 0; node < node_count(lattices[i]); ++node) {
      const std::vector<double> shares = boxes[i].shares(node_state(lattices[i], node));
      std::array<double, 4> sums{};
      for (std::size_t p = 0; p < shares.size(); ++p) {
        const LayerResponse& r = at_points[i][p];
        const std::array<double, 4> values = {r.reflection_above, r.transmission_down,
                                              r.reflection_below, r.transmission_up};
        for (std::size_t which = 0; which < 4; ++which) sums[which] += shares[p] * values[which];
      }
      for (std::size_t which = 0; which < 4; ++which)
        totals[i][which].push_back(std::max(0.0, sums[which]));
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
