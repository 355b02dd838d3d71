// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/internal/way_out.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"

namespace lamina::detail {
namespace {

/// Integral of exp(-a z) over [0, d]; d may be infinite.
double decay(double a, double d) {
  if (!std::isfinite(d)) return 1.0 / a;
  return a > 0.0 ? -std::expm1(-a * d) / a : d;
}

/// Light of one way that leaves anywhere, as its profile has it at one distance: there each angle
/// has one depth, here all depths of each angle are summed in closed form.
double from_way(const OnceScattered& light, const WayOut& way) {
  const GridStack& stack = light.stack;
  const GridLayer& layer = stack.layers[way.source];
  const double widest = widest_out(stack, way.source, way.ends_above), d = layer.thickness;
  const double down = light.beam.down[2 * way.source], up = light.beam.up[2 * way.source + 1];
  const double beam_near = way.starts_up ? down : up, beam_far = way.starts_up ? up : down;
  const PhaseFunction& phase = light.phase[way.source];
  const double sigma = layer.sigma_t;
  const auto density = [&](double theta) {
    const double p = widest * std::sin(theta), cos = cos_of(p, layer.ior);
    if (!(cos > 0.0)) return 0.0;
    double source =
        beam_near * evaluate(phase, -cos) * decay(std::max(sigma + sigma / cos, 1e-300), d);
    if (beam_far > 0.0)
      source += beam_far * evaluate(phase, cos) * std::exp(-sigma * d) *
                decay(sigma * (1.0 / cos - 1.0), d);
    return source * through(stack, way, p) * widest * std::cos(theta) * p /
           (layer.ior * layer.ior * cos);
  };
  // Panels in a geometric series, for phase functions with a peak, cut at the critical angles.
  constexpr double widest_angle = 0.5 * std::numbers::pi;
  std::vector<double> cuts{0.0};
  for (double angle = 0.01; angle < widest_angle; angle *= 2.0) cuts.push_back(angle);
  cuts.push_back(widest_angle);
  for (const double ior : stack.ior)
    if (ior < widest) cuts.push_back(std::asin(ior / widest));
  std::sort(cuts.begin(), cuts.end());
  static const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t c = 1; c < cuts.size(); ++c)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double t = rule.nodes[i], width = cuts[c] - cuts[c - 1];
      // Nodes crowd at both ends, where Fresnel's law has square roots.
      sum += width * 6.0 * t * (1.0 - t) * rule.weights[i] *
             density(cuts[c - 1] + width * t * t * (3.0 - 2.0 * t));
    }
  return 2.0 * std::numbers::pi * light.sigma_s[way.source] * sum;
}

}  // namespace

SingleScatteringTotals single_scattering_totals(const OnceScattered& light) {
  SingleScatteringTotals totals;
  for (const WayOut& way : light.ways)
    (way.ends_above ? totals.reflectance : totals.transmittance) += from_way(light, way);
  return totals;
}

}  // namespace lamina::detail
