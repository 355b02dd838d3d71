// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/oblique_single_scattering.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"

namespace lamina::detail {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

constexpr double deepest_oblique = 30.0;  ///< optical depth where no light is left

/// Integral of exp(-a z) over [0, d]; d may be infinite.
Complex decay(Complex a, double d) {
  if (!std::isfinite(d)) return 1.0 / a;
  const Complex x = a * d;
  if (std::abs(x) < 1e-3) return d * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0)));
  return (1.0 - std::exp(-x)) / a;
}

/// Integral of exp(-a z - b (d - z)) over [0, d].
Complex passed(Complex a, Complex b, double d) {
  if (a.real() > b.real()) std::swap(a, b);
  return std::exp(-a * d) * decay(b - a, d);
}

}  // namespace

std::vector<FrequencyResponse> oblique_single_on_grid(const FrequencySolver& solver, double k) {
  const GridStack& stack = solver.stack;
  const auto azimuths = static_cast<std::size_t>(solver.modes) + 1;
  const std::size_t beam = stack.grid.extra[1];
  std::vector<double> phi(azimuths), wave(azimuths);
  for (std::size_t q = 0; q < azimuths; ++q) {
    phi[q] = (static_cast<double>(q) + 0.5) * pi / static_cast<double>(azimuths);
    wave[q] = k * std::cos(phi[q]);
  }
  const auto rate = [&](std::size_t l, std::size_t i, std::size_t q) {
    const GridLayer& layer = stack.layers[l];
    return Complex(node_extinction(layer, i) / layer.cos[i],
                   wave[q] * stack.grid.p[i] / (layer.ior * layer.cos[i]));
  };
  /// Straight on through whole layers and interfaces [from, to].
  const auto through = [&](std::size_t i, std::size_t q, std::size_t from, std::size_t to) {
    Complex light = 1.0;
    for (std::size_t j = from; j <= to; ++j)
      light *= 1.0 - interface_reflectance(stack, j, stack.grid.p[i]);
    for (std::size_t l = from; l < to; ++l)
      light *= std::exp(-rate(l, i, q) * stack.layers[l].thickness);
    return light;
  };
  std::vector<FrequencyResponse> result(azimuths);
  double beam_reaches = stack.ior[0];
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const GridLayer& layer = stack.layers[l];
    beam_reaches = std::min(beam_reaches, layer.ior);
    if (beam >= active_count(stack.grid, beam_reaches)) break;
    if (layer.sigma_s == 0.0) continue;
    // Of each azimuth of the beam, all that leaves on one side.
    const auto leaving = [&](std::size_t q, bool is_up) {
      const Leg leg{&stack, l, is_up, 0.0};
      Complex sum = 0.0;
      const Complex in = rate(l, beam, q);
      for (std::size_t i = 0; i < active_count(stack.grid, leg.widest()); ++i) {
        const double strength = 0.25 * layer.sigma_s * stack.grid.etendue[i] /
                                (layer.ior * layer.ior * layer.cos[i] * layer.cos[beam]);
        for (std::size_t o = 0; o < azimuths; ++o) {
          double density = 0.0;
          for (std::size_t m = 0; m < azimuths; ++m) {
            const PhaseMode& phase = solver.phase[l][m];
            const double unit = static_cast<double>(m);
            density += (m == 0 ? 1.0 : 2.0) * std::cos(unit * phi[q]) * std::cos(unit * phi[o]) *
                       (is_up ? phase.backward : phase.forward)(i, beam);
          }
          const Complex out = rate(l, i, o);
          const Complex over_depth =
              is_up ? decay(in + out, layer.thickness) : passed(in, out, layer.thickness);
          sum += strength * density * over_depth * through(i, o, leg.first(), leg.last());
        }
      }
      return sum * through(beam, q, 0, l) / static_cast<double>(azimuths);
    };
    for (std::size_t q = 0; q < azimuths; ++q) {
      const Complex up = leaving(q, true);
      const Complex down = has_open_bottom(stack) ? leaving(q, false) : Complex(0.0);
      for (std::size_t m = 0; m < azimuths; ++m) {
        const Complex turn = std::pow(Complex(0.0, -1.0), static_cast<int>(m));
        const double weight = (m == 0 ? 1.0 : std::numbers::sqrt2) *
                              std::cos(static_cast<double>(m) * phi[q]) /
                              static_cast<double>(azimuths);
        result[m].reflectance += (turn * up).real() * weight;
        result[m].transmittance += (turn * down).real() * weight;
      }
    }
  }
  return result;
}

SingleScatteringProfile oblique_single_profile(const LayerStack& stack, const GridStack& on_grid,
                                               double p, double x, double y) {
  static const Quadrature rule = gauss_legendre(10, 0.0, 1.0);
  SingleScatteringProfile profile;
  Leg beam{&on_grid, 0, true, 0.0};
  for (std::size_t l = 0; l < on_grid.layers.size(); ++l) {
    beam.layer = l;
    beam.z = 0.0;
    if (p >= beam.widest()) break;
    const double sigma_s = stack.layers()[l].medium.sigma_s;
    if (sigma_s == 0.0) continue;
    const GridLayer& layer = on_grid.layers[l];
    const PhaseFunction phase = phase_function(stack.layers()[l]);
    const double beam_cos = ray_cos(p, layer.ior);
    const double d = std::min(layer.thickness, deepest_oblique / layer.sigma_t);
    const auto leaving = [&](bool is_up) {
      Leg exit{&on_grid, l, is_up, 0.0};
      const double widest = exit.widest();
      const auto at_depth = [&](double z) {  // below the layer's upper face
        beam.z = z;
        exit.z = is_up ? z : layer.thickness - z;
        const double dx = x - beam.aside(p), a = std::max(std::hypot(dx, y), 1e-12);
        if (a >= exit.aside(widest)) return 0.0;
        const double q = exit.p_at(a, widest), cos = ray_cos(q, layer.ior);
        const double across = p * q / (layer.ior * layer.ior) * dx / a;
        const double cos_theta = across + (is_up ? -1.0 : 1.0) * beam_cos * cos;
        return sigma_s / beam_cos * beam.through(p) *
               evaluate(phase, std::clamp(cos_theta, -1.0, 1.0)) * exit.through(q) * q /
               (layer.ior * layer.ior * cos * a * exit.slope(q));
      };
      // Panels grow away from the face where the light leaves, from the distance to there on.
      beam.z = is_up ? 0.0 : d;
      const double outside = exit.depth() + std::hypot(x - beam.aside(p), y);
      double sum = 0.0, low = 0.0, width = std::max(0.25 * outside, 1e-9 * d);
      while (low < d) {
        const double high = low + 1.5 * width >= d ? d : low + width;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
          const double from_face = low + (high - low) * rule.nodes[i];
          sum += rule.weights[i] * (high - low) * at_depth(is_up ? from_face : d - from_face);
        }
        low = high;
        width = std::min(1.5 * width, 1.0 / layer.sigma_t);
      }
      return sum;
    };
    profile.reflectance += leaving(true);
    if (has_open_bottom(on_grid)) profile.transmittance += leaving(false);
  }
  return profile;
}

}  // namespace lamina::detail
