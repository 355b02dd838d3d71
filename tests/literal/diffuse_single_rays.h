// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"

namespace lamina::detail::single_rays {

using std::numbers::pi;

inline const Quadrature& rule(int n) {
  static const Quadrature six = gauss_legendre(12, 0.0, 1.0),
                          sixteen = gauss_legendre(32, 0.0, 1.0);
  return n == 6 ? six : sixteen;
}

/// Light of a point at distance 0 that one layer scatters at one depth, seen from the point at
/// distance r, over the strength of scattering.
///
/// The integral over the horizontal plane goes in polar coordinates around the start of `near`, up
/// to a point's p and azimuth. In the half of the plane nearer to that start only, if `is_half`.
inline double plane_integral(const Leg& near, const Leg& far, const PhaseFunction& phase, double r,
                             bool turns, bool is_half) {
  const double ior = near.stack->layers[near.layer].ior;
  const double near_widest = near.widest(), far_widest = far.widest();
  const double near_limit = near.aside(near_widest), far_limit = far.aside(far_widest);
  const double closest = std::max(0.0, r - far_limit);
  if (closest >= near_limit) return 0.0;
  const double from =
      closest > 0.0 ? std::asin(std::min(1.0, near.p_at(closest, near_widest) / near_widest)) : 0.0;
  double sum = 0.0;
  const Quadrature& nodes = rule(16);
  for (std::size_t u = 0; u < nodes.nodes.size(); ++u) {
    const double angle = from + (0.5 * pi - from) * nodes.nodes[u];
    const double p = near_widest * std::sin(angle);
    const double cos = ray_cos(p, ior), a = near.aside(p);
    // Cosines of the azimuths between which the other leg reaches r.
    const double widest_azimuth =
        std::isfinite(far_limit) && a > 0.0
            ? std::acos(
                  std::clamp((r * r + a * a - far_limit * far_limit) / (2.0 * r * a), -1.0, 1.0))
            : pi;
    const double first_azimuth =
        is_half && 2.0 * a > r ? std::acos(std::clamp(r / (2.0 * a), -1.0, 1.0)) : 0.0;
    if (!(widest_azimuth > first_azimuth)) continue;
    double ring = 0.0;
    for (std::size_t v = 0; v < nodes.nodes.size(); ++v) {
      const double t = nodes.nodes[v];
      const double span = widest_azimuth - first_azimuth;
      const double azimuth = first_azimuth + span * std::sin(0.5 * pi * t);
      const double weight = nodes.weights[v] * span * 0.5 * pi * std::cos(0.5 * pi * t);
      const double b = std::sqrt(std::max(r * r + a * a - 2.0 * r * a * std::cos(azimuth), 1e-300));
      if (b >= far_limit) continue;
      const double q = far.p_at(b, far_widest), far_cos = ray_cos(q, ior);
      const double turn = (r * std::cos(azimuth) - a) / b;  // cosine between the horizontal ways
      const double across = p * q / (ior * ior) * turn, along = cos * far_cos;
      const double cos_theta = std::clamp(turns ? across - along : across + along, -1.0, 1.0);
      ring += weight * evaluate(phase, cos_theta) * far.through(q) * q /
              (ior * ior * far_cos * b * far.slope(q));
    }
    // Half of the azimuths mirror the others.
    sum += nodes.weights[u] * (0.5 * pi - from) * near_widest * std::cos(angle) * 2.0 * p *
           near.through(p) / cos * ring / pi;
  }
  return sum;
}

/// Depths of a layer for a composite rule, in panels that grow away from the start.
template <class F>
inline double over_depths(const F& f, double from, double to, double first_panel) {
  const Quadrature& nodes = rule(6);
  double sum = 0.0, low = from, width = first_panel;
  while (low < to) {
    const double high = low + 1.5 * width >= to ? to : low + width;
    double panel = 0.0;
    for (std::size_t i = 0; i < nodes.nodes.size(); ++i)
      panel += nodes.weights[i] * (high - low) * f(low + (high - low) * nodes.nodes[i]);
    sum += panel;
    if (panel < 1e-7 * sum) break;
    low = high;
    width *= 2.0;
  }
  return sum;
}

inline double first_panel_width(const GridLayer& layer, double r) {
  return 0.5 * std::min({r, layer.thickness, 1.0 / layer.sigma_t});
}

/// Scattered back: by symmetry twice the light of the half-plane nearer to where it enters.
inline double turned_in_layer(const GridStack& stack, std::size_t l, const PhaseFunction& phase,
                              const TopPassage* top, double r) {
  const GridLayer& layer = stack.layers[l];
  const auto at = [&](double z) {
    const Leg leg{&stack, l, true, z, top};
    return 2.0 * plane_integral(leg, leg, phase, r, true, true);
  };
  // The least depth at which rays from both points meet.
  const auto meets = [&](double z) {
    const Leg leg{&stack, l, true, z, top};
    return 2.0 * leg.aside(leg.widest()) > r;
  };
  double from = 0.0;
  if (!meets(0.0)) {
    double high = std::isfinite(layer.thickness) ? layer.thickness : r;
    while (!std::isfinite(layer.thickness) && !meets(high)) high *= 2.0;
    if (!meets(high)) return 0.0;
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (from + high);
      (meets(middle) ? high : from) = middle;
    }
    from = high;
  }
  return over_depths(at, from, layer.thickness, first_panel_width(layer, r));
}

/// Scattered on: in the upper half of the layer around where it enters, in the lower half around
/// where it leaves.
inline double passed_in_layer(const GridStack& stack, std::size_t l, const PhaseFunction& phase,
                              const TopPassage* top, double r) {
  const GridLayer& layer = stack.layers[l];
  const double d = layer.thickness, panel = first_panel_width(layer, r);
  const auto upper = [&](double z) {
    return plane_integral({&stack, l, true, z, top}, {&stack, l, false, d - z}, phase, r, false,
                          false);
  };
  // Light going the other way is scattered alike; its etendue is counted at the other end.
  const auto lower = [&](double z) {
    return plane_integral({&stack, l, false, z}, {&stack, l, true, d - z, top}, phase, r, false,
                          false);
  };
  return over_depths(upper, 0.0, 0.5 * d, panel) + over_depths(lower, 0.0, 0.5 * d, panel);
}

/// Profile of diffuse light from above on one point that is scattered once and neither before nor
/// after reflected, at distance r [mm] > 0 from that point [1/mm²]: ray by ray, slowly.
///
/// @param on_grid  the same stack on any grid.
/// @param top      of a solver of the stack.
inline SingleScatteringProfile profile_at(const LayerStack& stack, const GridStack& on_grid,
                                          const TopPassage& top, double r) {
  SingleScatteringProfile profile;
  const TopPassage* const rough = top.is_rough ? &top : nullptr;
  const double above2 = on_grid.ior[0] * on_grid.ior[0];
  for (std::size_t l = 0; l < on_grid.layers.size(); ++l) {
    const double sigma_s = stack.layers()[l].medium.sigma_s;
    if (sigma_s == 0.0) continue;
    const PhaseFunction phase = phase_function(stack.layers()[l]);
    profile.reflectance += sigma_s / above2 * turned_in_layer(on_grid, l, phase, rough, r);
    if (has_open_bottom(on_grid))
      profile.transmittance += sigma_s / above2 * passed_in_layer(on_grid, l, phase, rough, r);
  }
  return profile;
}

}  // namespace lamina::detail::single_rays
