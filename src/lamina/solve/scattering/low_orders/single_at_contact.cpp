// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/single_at_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "lamina/base/core/lazy_values.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"

namespace lamina::detail {
namespace {

/// single_at_contact over the strength of scattering.
double contact_integral(const PhaseFunction& phase, const GridStack& on_grid,
                        const TopPassage& top) {
  using std::numbers::pi;
  const double ior = on_grid.ior[1];
  const auto smooth = [&](double p) { return 1.0 - interface_reflectance(on_grid, 0, p); };
  const auto in_at = [&](double p) { return top.is_rough ? top.in_at(p) : smooth(p); };
  const auto out_at = [&](double p) { return top.is_rough ? top.out_at(p) : smooth(p); };
  // Rays of one direction in and one out make a distance that grows with depth by the sum of their
  // slopes: 1 over its length counts. Where it vanishes, for slopes that are alike and opposite,
  // panels are short.
  const auto panels = [](std::vector<double> edges) {
    static const Quadrature rule = gauss_legendre(8, 0.0, 1.0);
    std::ranges::sort(edges);
    Quadrature all;
    for (std::size_t e = 0; e + 1 < edges.size(); ++e)
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        all.nodes.push_back(edges[e] + (edges[e + 1] - edges[e]) * rule.nodes[i]);
        all.weights.push_back((edges[e + 1] - edges[e]) * rule.weights[i]);
      }
    return all;
  };
  // The widest angle inside that light passes at; near it Fresnel's law has a square root.
  const double widest = top.is_rough ? 0.5 * pi : std::asin(std::min(1.0, on_grid.ior[0] / ior));
  std::vector<double> edges_in{0.0, widest};
  if (top.is_rough) {
    const double lobe = top.boundary.facets.alpha * std::abs(1.0 - on_grid.ior[0] / ior);
    for (double angle = widest; angle > 0.05 * lobe;) edges_in.push_back(angle *= 0.5);
  } else {
    for (double step = 0.5; step > 1e-3; step *= 0.25) edges_in.push_back(widest * (1.0 - step));
  }
  std::vector<double> edges_turn{0.0, pi};
  for (double angle = pi; angle > 1e-2;) edges_turn.push_back(angle *= 0.4);
  const Quadrature in = panels(edges_in), turns = panels(edges_turn);
  double sum = 0.0;
  for (std::size_t i = 0; i < in.nodes.size(); ++i) {
    const double sine = std::sin(in.nodes[i]), cos = std::cos(in.nodes[i]), slope = sine / cos;
    const double light = in_at(ior * sine) * 2.0 * ior * ior * sine;  // over cos
    if (!(std::abs(light) > 0.0)) continue;
    std::vector<double> edges_out{0.0, in.nodes[i], widest};
    for (double step = 0.4; step > 1e-3; step *= 0.4)
      for (const double edge :
           {in.nodes[i] * (1.0 - step), in.nodes[i] + (widest - in.nodes[i]) * step,
            widest - (widest - in.nodes[i]) * step})
        edges_out.push_back(edge);
    const Quadrature out = panels(edges_out);
    double scattered = 0.0;
    for (std::size_t o = 0; o < out.nodes.size(); ++o) {
      const double out_sine = std::sin(out.nodes[o]), out_cos = std::cos(out.nodes[o]);
      const double out_slope = out_sine / out_cos;
      double ring = 0.0;
      for (std::size_t t = 0; t < turns.nodes.size(); ++t) {
        const double turn = -std::cos(turns.nodes[t]);  // from opposite
        const double apart =
            std::sqrt(slope * slope + out_slope * out_slope + 2.0 * slope * out_slope * turn);
        const double cos_theta = sine * out_sine * turn - cos * out_cos;
        ring += 2.0 * turns.weights[t] * evaluate(phase, std::clamp(cos_theta, -1.0, 1.0)) /
                std::max(apart, 1e-12);
      }
      scattered += out.weights[o] * out_sine * out_at(ior * out_sine) * ring;
    }
    sum += in.weights[i] * light * scattered;
  }
  return sum / (on_grid.ior[0] * on_grid.ior[0]);
}

/// Appends the numbers of a phase function.
void append(const HenyeyGreenstein& phase, std::vector<double>& key) { key.push_back(phase.g); }
void append(const Rayleigh&, std::vector<double>& key) { key.push_back(2.0); }  // no g is
void append(const PhaseMixture& phase, std::vector<double>& key) {
  for (const PhaseMixture::Lobe& lobe : phase.lobes) {
    key.push_back(lobe.weight);
    std::visit([&](const auto& kind) { append(kind, key); }, lobe.phase);
  }
}

}  // namespace

double single_at_contact(const LayerStack& stack, const GridStack& on_grid, const TopPassage& top) {
  const double sigma_s = stack.layers()[0].medium.sigma_s;
  if (sigma_s == 0.0) return 0.0;
  const PhaseFunction phase = phase_function(stack.layers()[0]);
  if (top.is_rough) return sigma_s * contact_integral(phase, on_grid, top);
  // A material that is edited, or made darker, keeps its index and phase function.
  static KeptValues<std::vector<double>, double> kept(256);
  std::vector<double> key{on_grid.ior[0], on_grid.ior[1]};
  std::visit([&](const auto& kind) { append(kind, key); }, phase);
  return sigma_s * kept.at(key, [&] { return contact_integral(phase, on_grid, top); });
}

}  // namespace lamina::detail
