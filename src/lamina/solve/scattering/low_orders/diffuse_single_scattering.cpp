// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/low_orders/diffuse_single_scattering.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"
#include "lamina/solve/scattering/profile/bessel.h"

namespace lamina::detail {
namespace {

constexpr double deepest = 20.0;      ///< optical depth where no light is left
constexpr double first_panel = 0.02;  ///< optical depth of the first panel of depths
constexpr double least_mode = 1e-5;   ///< modes of a phase function below this do not count
constexpr double finest_phase = 2.0;  ///< times the nodes: waves of larger phase cancel out
constexpr double least_light = 1e-11;

/// Depths of a layer in panels that grow away from its faces.
Quadrature depths(double thickness, double sigma_t, double first, int nodes) {
  const bool has_bottom = std::isfinite(thickness);
  const double half = has_bottom ? 0.5 * thickness : deepest / sigma_t;
  std::vector<double> edges{half};
  while (edges.back() > first && edges.size() < 40) edges.push_back(0.5 * edges.back());
  edges.push_back(0.0);
  std::ranges::reverse(edges);
  if (has_bottom)
    for (std::size_t i = edges.size() - 1; i-- > 0;) edges.push_back(thickness - edges[i]);
  Quadrature all;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    // Within a deep layer away from both faces nothing is left to scatter.
    const double from_face = has_bottom ? std::min(edges[i], thickness - edges[i + 1]) : edges[i];
    if (from_face * sigma_t > deepest) continue;
    const Quadrature panel = gauss_legendre(nodes, edges[i], edges[i + 1]);
    all.nodes.insert(all.nodes.end(), panel.nodes.begin(), panel.nodes.end());
    all.weights.insert(all.weights.end(), panel.weights.begin(), panel.weights.end());
  }
  return all;
}

/// What lies between a layer and one side of the stack.
struct Way {
  std::size_t first, last;  ///< interfaces, and layers but for the last
  double widest;            ///< p up to which light gets through
};
Way make_way(const GridStack& stack, std::size_t layer, bool is_top) {
  Way way{is_top ? 0 : layer + 1, is_top ? layer : stack.layers.size(), stack.ior[layer + 1]};
  for (std::size_t q = way.first; q <= way.last; ++q)
    if (q > 0 || !has_rough_top(stack))
      way.widest = std::min({way.widest, stack.ior[q], stack.ior[q + 1]});
  return way;
}

/// @param through_top  [node]
DiffuseSingle::Rays make_rays(const GridStack& stack, std::size_t layer, bool is_top,
                              const std::vector<double>& through_top,
                              const std::vector<double>& depth,
                              const std::vector<double>& extinction) {
  const auto [first, last, widest] = make_way(stack, layer, is_top);
  DiffuseSingle::Rays rays;
  rays.nodes = active_count(stack.grid, widest);  // the beam has no weight
  for (const double z : depth)
    for (std::size_t i = 0; i < rays.nodes; ++i) {
      double light = stack.grid.etendue[i] / stack.layers[layer].cos[i], aside = 0.0;
      const auto go = [&](std::size_t l, double d) {
        const double cos = stack.layers[l].cos[i];
        light *= std::exp(-extinction[l] * d / cos);
        aside += d * stack.grid.p[i] / (stack.layers[l].ior * cos);
      };
      for (std::size_t q = first; q <= last; ++q)
        light *= q == 0 ? through_top[i] : 1.0 - interface_reflectance(stack, q, stack.grid.p[i]);
      for (std::size_t l = first; l < last; ++l) go(l, stack.layers[l].thickness);
      go(layer, is_top ? z : stack.layers[layer].thickness - z);
      rays.light.push_back(light);
      rays.aside.push_back(aside);
    }
  return rays;
}

/// The rays of one depth as a wave, [mode][node]; 0 in light of a phase that cancels out.
/// @return the highest mode that holds light; -1 if none does
int waves(const DiffuseSingle::Rays& rays, std::size_t depth, int modes, double k,
          std::vector<double>& out, std::vector<double>& one) {
  const std::size_t n = rays.nodes;
  const double cut = finest_phase * static_cast<double>(n);
  out.assign(static_cast<std::size_t>(modes + 1) * n, 0.0);
  int highest = -1;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = k * rays.aside[depth * n + i];
    if (std::abs(rays.light[depth * n + i]) < least_light || x > 2.0 * cut) continue;
    const double of_cut = x / cut, squared = of_cut * of_cut, fourth = squared * squared;
    const double light = rays.light[depth * n + i] * std::exp(-fourth * fourth);
    // Beyond m = x the functions vanish.
    const int last = std::min(modes, static_cast<int>(x + 6.0 * std::cbrt(x)) + 4);
    tabulated_bessel_functions(x, std::span(one).first(static_cast<std::size_t>(last) + 1));
    for (int m = 0; m <= last; ++m)
      out[static_cast<std::size_t>(m) * n + i] = light * one[static_cast<std::size_t>(m)];
    highest = std::max(highest, last);
  }
  return highest;
}

/// Four sums at once: each addition would wait for the one before.
double dot(const double* a, const double* b, std::size_t count) {
  double sum[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (std::size_t q = 0; q < 4; ++q) sum[q] += a[i + q] * b[i + q];
  for (; i < count; ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// The last mode of a phase function that counts: they only fall.
int last_mode(const std::vector<PhaseMode>& phase) {
  const auto largest = [](const Matrix& kernel) {
    double most = 0.0;
    for (const double value : kernel.values) most = std::max(most, std::abs(value));
    return most;
  };
  const double least = least_mode * largest(phase[0].forward);
  std::size_t last = phase.size() - 1;
  while (last > 0 && largest(phase[last].forward) < least) --last;
  return static_cast<int>(last);
}

}  // namespace

DiffuseSingle make_diffuse_single(const FrequencySolver& solver,
                                  const std::vector<double>& extinction, int depth_nodes) {
  const GridStack& stack = solver.stack;
  DiffuseSingle single;
  double densest = 0.0;
  for (const GridLayer& layer : stack.layers) densest = std::max(densest, layer.sigma_t);
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const GridLayer& layer = stack.layers[l];
    if (layer.sigma_s == 0.0) continue;
    const Quadrature z = depths(layer.thickness, layer.sigma_t, first_panel / densest, depth_nodes);
    auto& made = single.layers.emplace_back();
    made.strength = 0.25 * layer.sigma_s / (layer.ior * layer.ior * stack.ior[0] * stack.ior[0]);
    made.depth_weight = z.weights;
    const auto rays = [&](bool is_top, const std::vector<double>& through_top) {
      return make_rays(stack, l, is_top, through_top, z.nodes, extinction);
    };
    made.from_top = rays(true, solver.top.in);
    if (solver.top.in != solver.top.out) made.to_top = rays(true, solver.top.out);
    if (has_open_bottom(stack)) made.from_bottom = rays(false, {});
    made.phase = &solver.phase[l];
    made.modes = last_mode(solver.phase[l]);
  }
  return single;
}

FrequencyResponse single_response(const DiffuseSingle& single, double k) {
  FrequencyResponse result;
  std::vector<double> top, out, bottom, one;
  for (const DiffuseSingle::Layer& layer : single.layers) {
    one.resize(static_cast<std::size_t>(layer.modes) + 1);
    const auto meet = [&](const std::vector<double>& a, std::size_t a_nodes,
                          const std::vector<double>& b, std::size_t b_nodes, bool turns,
                          int modes) {
      double sum = 0.0;
      for (int m = 0; m <= modes; ++m) {
        const auto at = static_cast<std::size_t>(m);
        const PhaseMode& phase = (*layer.phase)[at];
        const Matrix& kernel = turns ? phase.backward : phase.forward;
        double of_mode = 0.0;
        for (std::size_t j = 0; j < b_nodes; ++j) {
          const double wave = b[at * b_nodes + j];
          if (wave == 0.0) continue;
          const double* column = &kernel.values[j * kernel.rows];
          of_mode += wave * dot(column, &a[at * a_nodes], a_nodes);
        }
        sum += (m == 0 ? 1.0 : m % 2 == 0 ? 2.0 : -2.0) * of_mode;
      }
      return sum;
    };
    const std::size_t down = layer.from_top.nodes, up = layer.from_bottom.nodes;
    for (std::size_t z = 0; z < layer.depth_weight.size(); ++z) {
      const double weight = layer.strength * layer.depth_weight[z];
      const int top_modes = waves(layer.from_top, z, layer.modes, k, top, one);
      if (top_modes < 0) break;
      if (layer.to_top.nodes == 0) {
        result.reflectance += weight * meet(top, down, top, down, true, top_modes);
      } else {
        const int modes = std::min(top_modes, waves(layer.to_top, z, layer.modes, k, out, one));
        result.reflectance += weight * meet(top, down, out, down, true, modes);
      }
      if (up == 0) continue;
      const int modes =
          std::min(top_modes, waves(layer.from_bottom, z, layer.modes, k, bottom, one));
      result.transmittance += weight * meet(top, down, bottom, up, false, modes);
    }
  }
  return result;
}

namespace {

using Complex = std::complex<double>;

/// All waves instead of the real part of half of them, so that their products are real, too.
AzimuthWaves with_conjugates(const AzimuthWaves& waves) {
  AzimuthWaves all{.rate = {}, .weight = std::vector<std::vector<Complex>>(waves.weight.size())};
  for (std::size_t q = 0; q < waves.rate.size(); ++q) {
    const bool is_real = waves.rate[q].imag() == 0.0;
    for (const bool is_conjugate : {false, true}) {
      if (is_real && is_conjugate) continue;
      const auto side = [&](Complex c) { return is_conjugate ? std::conj(c) : c; };
      all.rate.push_back(side(waves.rate[q]));
      for (std::size_t m = 0; m < waves.weight.size(); ++m)
        all.weight[m].push_back((is_real ? 1.0 : 0.5) * side(waves.weight[m][q]));
    }
  }
  return all;
}

/// Directions in a layer and their light at the face nearer to one side, [node][wave].
struct Face {
  std::vector<std::size_t> nodes;
  std::vector<Complex> light, rate, passed;  ///< passed: what is left at the other face
};
Face make_face(const GridStack& stack, const std::vector<Complex>& waves, double k, std::size_t l,
               bool is_above, const std::vector<double>& through_top) {
  const auto rate_in = [&](const GridLayer& layer, std::size_t i, Complex wave) {
    return node_extinction(layer, i) / layer.cos[i] -
           k * stack.grid.p[i] / (layer.ior * layer.cos[i]) * wave;
  };
  const Way way = make_way(stack, l, is_above);
  Face face;
  for (std::size_t i = 0; i < active_count(stack.grid, way.widest); ++i)
    if (i != stack.grid.extra[0]) face.nodes.push_back(i);
  for (const std::size_t i : face.nodes) {
    double through = stack.grid.etendue[i] / stack.layers[l].cos[i];
    for (std::size_t q = way.first; q <= way.last; ++q)
      through *= q == 0 ? through_top[i] : 1.0 - interface_reflectance(stack, q, stack.grid.p[i]);
    for (const Complex w : waves) {
      Complex light = through;
      for (std::size_t o = way.first; o < way.last; ++o)
        light *= std::exp(-rate_in(stack.layers[o], i, w) * stack.layers[o].thickness);
      face.light.push_back(light);
      face.rate.push_back(rate_in(stack.layers[l], i, w));
      face.passed.push_back(std::isfinite(stack.layers[l].thickness)
                                ? std::exp(-face.rate.back() * stack.layers[l].thickness)
                                : 0.0);
    }
  }
  return face;
}

}  // namespace

FrequencyResponse diffuse_single_on_grid(const FrequencySolver& solver, double k) {
  const GridStack& stack = solver.stack;
  const auto [rates, weights] = with_conjugates(solver.waves);
  const std::size_t waves = rates.size();
  const double arriving = stack.ior[0] * stack.ior[0];
  FrequencyResponse result;

  // From mode 0 to mode m by one wave, and back by another.
  const std::size_t modes = weights.size();
  std::vector<Complex> series(waves * waves * modes);
  for (std::size_t a = 0; a < waves; ++a)
    for (std::size_t b = 0; b < waves; ++b)
      for (std::size_t m = 0; m < modes; ++m)
        series[(a * waves + b) * modes + m] =
            (m % 2 == 0 ? 1.0 : -1.0) * weights[m][a] * weights[m][b];
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const GridLayer& layer = stack.layers[l];
    if (layer.sigma_s == 0.0) continue;
    const double d = layer.thickness;
    const auto scattered = [&](const Face& from, const Face& to, bool turns) {
      Complex sum = 0.0;
      for (std::size_t n = 0; n < from.nodes.size(); ++n)
        for (std::size_t o = 0; o < to.nodes.size(); ++o)
          for (std::size_t a = 0; a < waves; ++a)
            for (std::size_t b = 0; b < waves; ++b) {
              Complex density = 0.0;
              for (std::size_t m = 0; m < modes; ++m) {
                const PhaseMode& phase = solver.phase[l][m];
                density += series[(a * waves + b) * modes + m] *
                           (turns ? phase.backward : phase.forward)(from.nodes[n], to.nodes[o]);
              }
              const std::size_t in = n * waves + a, out = o * waves + b;
              const Complex both = from.rate[in] + to.rate[out];
              const Complex apart = from.rate[in] - to.rate[out];
              const Complex over_depth = turns ? (1.0 - from.passed[in] * to.passed[out]) / both
                                         : std::abs(apart) * d < 1e-6
                                             ? d * from.passed[in]
                                             : (to.passed[out] - from.passed[in]) / apart;
              sum += from.light[in] * to.light[out] * density * over_depth;
            }
      return sum.real();
    };
    const double strength = 0.25 * layer.sigma_s / (layer.ior * layer.ior * arriving);
    const Face above = make_face(stack, rates, k, l, true, solver.top.in);
    result.reflectance +=
        strength * scattered(above, make_face(stack, rates, k, l, true, solver.top.out), true);
    if (has_open_bottom(stack))
      result.transmittance +=
          strength * scattered(above, make_face(stack, rates, k, l, false, {}), false);
  }
  return result;
}

}  // namespace lamina::detail
