// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/exact_profile_single.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lamina/core/quadrature.h"
#include "lamina/optics/fresnel.h"

namespace lamina::detail {
namespace {

double cos_of(double p, double ior) {
  return std::sqrt(std::max(0.0, (1.0 - p / ior) * (1.0 + p / ior)));
}

double tangent(double p, double ior) { return p / (ior * std::max(cos_of(p, ior), 1e-150)); }

/// The way of light from the layer `source` out at the top or the bottom.
struct WayOut {
  const GridStack* stack;
  std::size_t source;
  bool is_up;

  [[nodiscard]] std::size_t first() const { return is_up ? 0 : source + 1; }
  [[nodiscard]] std::size_t last() const { return is_up ? source : stack->layers.size(); }

  /// The widest p that gets out.
  [[nodiscard]] double widest() const {
    double p = stack->ior[source + 1];
    for (std::size_t q = first(); q <= last(); ++q)
      p = std::min({p, stack->ior[q], stack->ior[q + 1]});
    return p;
  }
  /// How far to the side it goes in the layers between.
  [[nodiscard]] double aside(double p) const {
    double x = 0.0;
    for (std::size_t q = first(); q < last(); ++q)
      x += stack->layers[q].thickness * tangent(p, stack->layers[q].ior);
    return x;
  }
  /// What the layers between and the interfaces let through.
  [[nodiscard]] double through(double p) const {
    double t = 1.0;
    for (std::size_t q = first(); q <= last(); ++q) {
      const double near = stack->ior[q + 1], far = stack->ior[q];
      t *= 1.0 - fresnel(std::min(1.0, cos_of(p, near)), far / near);
    }
    for (std::size_t q = first(); q < last(); ++q)
      t *= std::exp(-stack->layers[q].sigma_t * stack->layers[q].thickness /
                    cos_of(p, stack->layers[q].ior));
    return t;
  }
};

/// Angle theta, p = widest sin(theta), at which a distance that grows with p reaches r.
template <class Distance>
double angle_where(const Distance& distance, double widest, double r) {
  double low = 0.0, high = 0.5 * std::numbers::pi;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (distance(widest * std::sin(middle)) > r ? high : low) = middle;
  }
  return high;
}

const Quadrature& panel_rule() {
  static const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  return rule;
}

/// Light that leaves at distance r, scattered in one layer: one integral over the angle, whose
/// every angle has one depth from which it arrives at r.
double from_layer(const WayOut& way, const PhaseFunction& phase, double sigma_s, double beam_near,
                  double beam_far, double r) {
  const GridLayer& layer = way.stack->layers[way.source];
  const double widest = way.widest(), d = layer.thickness;
  const auto near_edge = [&](double p) { return way.aside(p); };
  const auto far_edge = [&](double p) { return way.aside(p) + d * tangent(p, layer.ior); };
  const double from = std::isfinite(d) ? angle_where(far_edge, widest, r) : 0.0;
  const double to = angle_where(near_edge, widest, r);
  if (!(to > from)) return 0.0;
  const auto density = [&](double theta) {
    const double p = widest * std::sin(theta), cos = cos_of(p, layer.ior);
    const double tan = tangent(p, layer.ior);
    if (!(tan > 0.0) || !(cos > 0.0)) return 0.0;
    const double z = std::clamp((r - way.aside(p)) / tan, 0.0, d);  // from the face it leaves by
    const double sigma = layer.sigma_t;
    double source = beam_near * std::exp(-sigma * z) * evaluate(phase, -cos);
    if (beam_far > 0.0) source += beam_far * std::exp(-sigma * (d - z)) * evaluate(phase, cos);
    return source * std::exp(-sigma * z / cos) * way.through(p) * widest * std::cos(theta) * p /
           (layer.ior * layer.ior * cos * tan);
  };
  // The light of small r comes from small angles: panels in a geometric series from the first on.
  constexpr int panels = 16;
  double sum = 0.0, low = 0.0;
  for (int panel = 0; panel < panels; ++panel) {
    const double high = std::pow(10.0, -5.0 * (panels - 1 - panel) / (panels - 1));
    for (std::size_t i = 0; i < panel_rule().nodes.size(); ++i) {
      const double share = low + (high - low) * panel_rule().nodes[i];
      sum += (high - low) * panel_rule().weights[i] * density(from + (to - from) * share);
    }
    low = high;
  }
  // Over azimuth the phase function, a density over the sphere, counts 2 pi times.
  return sum * (to - from) * sigma_s * 2.0 * std::numbers::pi / (2.0 * std::numbers::pi * r);
}

}  // namespace

SingleScatteringProfile single_scattering_profile(const LayerStack& stack, const GridStack& on_grid,
                                                  double r) {
  SingleScatteringProfile profile;
  const UnscatteredFlux flux =
      unscattered_flux(on_grid, on_grid.grid.extra[0], Unscattered::scaled);
  const bool has_below = !on_grid.is_semi_infinite && on_grid.ground_reflectance == 0.0;
  for (std::size_t l = 0; l < on_grid.layers.size(); ++l) {
    const double sigma_s = stack.layers()[l].medium.sigma_s;
    if (sigma_s == 0.0) continue;
    const double down = flux.down[2 * l], up = flux.up[2 * l + 1];
    const PhaseFunction phase = phase_function(stack.layers()[l]);
    profile.reflectance += from_layer({&on_grid, l, true}, phase, sigma_s, down, up, r);
    if (has_below)
      profile.transmittance += from_layer({&on_grid, l, false}, phase, sigma_s, up, down, r);
  }
  return profile;
}

}  // namespace lamina::detail
