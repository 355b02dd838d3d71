// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_single.h"

#include <algorithm>
#include <cmath>

#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina::detail {
namespace {

/// (1 - exp(-x)) / x for x >= 0.
double mean_attenuation(double x) { return x > 0.0 ? -std::expm1(-x) / x : 1.0; }

/// Integral of exp(-(a + b) z) over [0, d]; d may be infinite.
double along(double a, double b, double d) {
  return std::isfinite(d) ? d * mean_attenuation((a + b) * d) : 1.0 / (a + b);
}

/// Integral of exp(-a z) exp(-b (d - z)) over [0, d].
double against(double a, double b, double d) {
  if (!std::isfinite(d)) return 0.0;
  return d * std::exp(-std::min(a, b) * d) * mean_attenuation(std::abs(a - b) * d);
}

}  // namespace

std::vector<LayerFlux> unscattered_from_above(const GridStack& stack, std::size_t node) {
  const UnscatteredFlux flux = unscattered_flux(stack, node, Unscattered::on_grid);
  std::vector<LayerFlux> layers;
  for (std::size_t k = 0; k < stack.layers.size(); ++k)
    layers.push_back({flux.down[2 * k], flux.up[2 * k + 1]});
  return layers;
}

std::vector<LayerFlux> unscattered_from_below(const GridStack& stack, std::size_t node) {
  // The same interreflections in the order that this light meets it: its "down" is up.
  const UnscatteredFlux flux = unscattered_flux(turned_over(stack), node, Unscattered::on_grid);
  std::vector<LayerFlux> layers;
  const std::size_t count = stack.layers.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t turned = count - 1 - k;
    layers.push_back({flux.up[2 * turned + 1], flux.down[2 * turned]});
  }
  return layers;
}

SingleScattering single_scattering(const GridLayer& layer, std::size_t in,
                                   const LayerFlux& arriving, std::size_t out,
                                   const LayerFlux& leaving) {
  if (std::max(in, out) >= layer.cos.size()) return {};
  const double a = node_extinction(layer, in) / layer.cos[in];
  const double b = node_extinction(layer, out) / layer.cos[out];
  const double d = layer.thickness;
  const double strength = 0.25 * layer.weight[in] * layer.weight[out];
  // `leaving.down` belongs to light that goes up inside, `leaving.up` to light that goes down.
  return {.same_side = strength * against(a, b, d) *
                       (arriving.down * leaving.up + arriving.up * leaving.down),
          .opposite_side = strength * along(a, b, d) *
                           (arriving.down * leaving.down + arriving.up * leaving.up)};
}

SingleFacet single_facet(const GridStack& stack, std::size_t beam, std::size_t out,
                         bool leaves_above) {
  const std::size_t layers = stack.layers.size();
  std::size_t k = 0;
  while (k <= layers && !is_rough(stack.interfaces[k], stack.ior[k], stack.ior[k + 1])) ++k;
  if (k > layers) return {};
  // What arrives at interface k from outside; by reciprocity also what leaves from there.
  const auto arriving = [](const GridStack& seen, std::size_t node, std::size_t interface) {
    if (interface == 0) return 1.0;
    return unscattered_flux(seen, node, Unscattered::on_grid).down[2 * interface - 1];
  };
  const double leaving =
      leaves_above ? arriving(stack, out, k) : arriving(turned_over(stack), out, layers - k);
  const double ior_inside = stack.ior[leaves_above ? k : k + 1];
  const double ratio = (leaves_above ? stack.ior.front() : stack.ior.back()) / ior_inside;
  return {.interface = k, .weight = arriving(stack, beam, k) * leaving * ratio * ratio};
}

double facet_radiance(const GridStack& stack, const SingleFacet& facet, std::size_t beam,
                      std::size_t out, bool leaves_above, double phi) {
  if (facet.weight == 0.0) return 0.0;
  const double before = stack.ior[facet.interface], behind = stack.ior[facet.interface + 1];
  const auto interface =
      make_rough_interface<double>(stack.interfaces[facet.interface], before, behind);
  const auto direction = [&](std::size_t node, double ior, double azimuth) {
    const double sine = stack.grid.p[node] / ior;
    return Vec3{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine(stack.grid, node, ior)};
  };
  Vec3 from = direction(beam, before, 0.0);
  from.x = -from.x;  // light that comes from there goes on towards azimuth 0
  Vec3 to = direction(out, leaves_above ? before : behind, phi);
  if (!leaves_above) to.z = -to.z;
  return facet.weight * bsdf(interface, from, to);
}

}  // namespace lamina::detail
