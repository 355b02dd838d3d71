// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/heterogeneous/internal/operator_totals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "lamina/scattering/adding_doubling/adding_doubling.h"
#include "lamina/scattering/diffusion/diffuse_boundary.h"
#include "lamina/scattering/profile/layer_response.h"

namespace lamina::detail {
namespace {

double ior_over(const MappedStack& stack, std::size_t layer) {
  return layer == 0 ? stack.ior_above : stack.layers[layer - 1].ior;
}

double ior_under(const MappedStack& stack, std::size_t layer) {
  return layer + 1 == stack.layers.size() ? stack.ior_below : stack.layers[layer + 1].ior;
}

Layer solid_layer(const MappedLayer& layer, double sigma_a) {
  return {.medium = {.sigma_a = sigma_a, .sigma_s = layer.sigma_s, .g = layer.g, .ior = layer.ior},
          .thickness = layer.thickness};
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

LayerResponse solve_layer(const MappedStack& stack, std::size_t i, double sigma_a, From outside) {
  const Layer layer = solid_layer(stack.layers[i], sigma_a);
  const double over = ior_over(stack, i), under = ior_under(stack, i);
  const Entered above = solve(LayerStack({layer}, over, under), i == 0 ? outside : From::neighbor);
  if (std::isinf(layer.thickness)) return {above.reflection, 0.0, 0.0, 0.0};
  const bool is_last = i + 1 == stack.layers.size();
  const Entered below = solve(LayerStack({layer}, under, over), is_last ? outside : From::neighbor);
  return {above.reflection, above.transmission, below.reflection, below.transmission};
}

/// A smooth function at n Chebyshev points of [-1, 1], [node].
std::vector<double> chebyshev_points(std::size_t n) {
  std::vector<double> x;
  for (std::size_t i = 0; i < n; ++i)
    x.push_back(
        std::cos(std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n)));
  return x;
}

/// The polynomial through values at Chebyshev points, by the barycentric formula [Berrut2004].
double interpolate(const std::vector<double>& points, const std::vector<double>& values, double x) {
  double above = 0.0, below = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (x == points[i]) return values[i];
    const double angle =
        std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(points.size());
    const double weight = (i % 2 == 0 ? 1.0 : -1.0) * std::sin(angle) / (x - points[i]);
    above += weight * values[i];
    below += weight;
  }
  return above / below;
}

/// The reflectance that a half-space must have for the whole stack to reflect `wanted`.
double reflection_for(const LayerResponse& cover, double wanted) {
  const double through = std::max(0.0, wanted - cover.reflection_above);
  return through /
         (cover.transmission_down * cover.transmission_up + through * cover.reflection_below);
}

}  // namespace

std::vector<LayerTotals> transfer_operator_totals(const MappedStack& stack,
                                                  std::span<const double> reference_sigma_a,
                                                  const GaussianTableGrid& grid,
                                                  bool is_lit_evenly) {
  assert(reference_sigma_a.size() == stack.layers.size());
  constexpr std::size_t nodes = 28;
  const std::vector<double> points = chebyshev_points(nodes);
  const std::size_t size = stack.layers.size();
  const From outside = is_lit_evenly ? From::outside_evenly : From::outside;
  const bool ends_in_half_space = size > 1 && std::isinf(stack.layers.back().thickness);

  // The layers above the last one, at their reference absorption, or at so much less that enough
  // light comes back through them to tell how the last one reflects.
  constexpr double enough = 1e-3;
  LayerResponse cover;
  std::vector<Layer> all;
  for (double share = 1.0; ends_in_half_space && all.empty(); share *= 0.5) {
    cover = LayerResponse{};
    for (std::size_t i = 0; i + 1 < size; ++i) {
      cover = stacked(cover, solve_layer(stack, i, share * reference_sigma_a[i], outside));
      all.push_back(solid_layer(stack.layers[i], share * reference_sigma_a[i]));
    }
    if (cover.transmission_down * cover.transmission_up < enough && share > 1e-3) all.clear();
  }

  std::vector<LayerTotals> totals(size);
  for (std::size_t i = 0; i < size; ++i) {
    LayerTotals at_nodes;
    for (const double x : points) {
      const double sigma_a =
          row_absorption(grid, 0.5 * (x + 1.0) * static_cast<double>(grid.rows - 1));
      LayerResponse r;
      if (ends_in_half_space && i + 1 == size) {
        std::vector<Layer> layers = all;
        layers.push_back(solid_layer(stack.layers[i], sigma_a));
        r.reflection_above = reflection_for(
            cover, solve(LayerStack(layers, stack.ior_above, stack.ior_below), outside).reflection);
      } else {
        r = solve_layer(stack, i, sigma_a, outside);
      }
      at_nodes[0].push_back(r.reflection_above), at_nodes[1].push_back(r.transmission_down);
      at_nodes[2].push_back(r.reflection_below), at_nodes[3].push_back(r.transmission_up);
    }
    for (std::size_t which = 0; which < 4; ++which)
      for (std::size_t row = 0; row < grid.rows; ++row) {
        const double x = 2.0 * static_cast<double>(row) / static_cast<double>(grid.rows - 1) - 1.0;
        totals[i][which].push_back(std::max(0.0, interpolate(points, at_nodes[which], x)));
      }
  }
  return totals;
}

std::pair<double, double> boundary_reflectances(const MappedStack& stack, std::size_t layer) {
  const double ior = stack.layers[layer].ior;
  return {diffuse_reflectance_inside({}, ior, ior_over(stack, layer), DiffuseFresnel::exact),
          diffuse_reflectance_inside({}, ior, ior_under(stack, layer), DiffuseFresnel::exact)};
}

}  // namespace lamina::detail
