// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"

namespace lamina::reference {

/// A stack on which the first-order formulas meet photons of order 1.
struct FirstOrderCase {
  std::string name;
  LayerStack stack;
  double theta_i = 0.0;  ///< [rad]
};

inline std::vector<FirstOrderCase> first_order_cases() {
  const auto layer = [](double albedo, double tau, double g, double ior) {
    return Layer{.medium = {.sigma_a = 1.0 - albedo, .sigma_s = albedo, .g = g, .ior = ior},
                 .thickness = tau};
  };
  constexpr double half_space = std::numeric_limits<double>::infinity();
  Layer rayleigh = layer(0.9, 0.8, 0.0, 1.0);
  rayleigh.phase = Rayleigh{};
  Layer mixed = layer(0.7, 1.0, 0.3, 1.0);
  mixed.phase = PhaseMixture{{{0.5, HenyeyGreenstein{0.8}}, {0.5, HenyeyGreenstein{-0.2}}}};
  return {
      {"matched slab, isotropic", LayerStack({layer(0.8, 0.5, 0.0, 1.0)}), 0.3},
      {"matched slab, forward", LayerStack({layer(0.6, 1.0, 0.8, 1.0)}), 0.9},
      {"matched slab, Rayleigh", LayerStack({rayleigh}), 1.1},
      {"matched slab, mixture", LayerStack({mixed}), 0.7},
      {"matched half-space, isotropic", LayerStack({layer(0.9, half_space, 0.0, 1.0)}), 0.5},
      {"matched half-space, backward", LayerStack({layer(0.5, half_space, -0.5, 1.0)}), 1.2},
      {"slab of index 1.33", LayerStack({layer(0.8, 0.5, 0.6, 1.33)}), 0.7},
      {"half-space of index 1.4", LayerStack({layer(0.8, half_space, 0.5, 1.4)}, 1.0, 1.4), 0.6},
      {"three layers",
       LayerStack(
           {layer(0.9, 0.3, 0.5, 1.5), layer(0.5, 0.5, 0.0, 1.33), layer(0.8, 0.4, 0.8, 1.45)}, 1.0,
           1.2),
       0.8},
      {"water on air", LayerStack({layer(0.8, 0.5, 0.7, 1.33)}, 1.0, 1.6), 0.4},
  };
}

/// Light scattered once into cells of cosine and azimuth, both sides, formula and photons.
struct FirstOrderComparison {
  double worst = 0.0;  ///< largest difference of a cell [standard errors]
  double chi2 = 0.0;   ///< sum of squared differences [standard errors²]
  int cells = 0;
  double worst_flux = 0.0;      ///< the same of the flux that leaves on a side
  double relative_error = 0.0;  ///< of the photons in a cell, mean over all
};

/// Mean over one cell of bsdf * cosine, over the cosine of the cell's middle: as photons are told.
inline double cell_mean(const FirstOrderStack<double>& stack, const StackBeam<double>& in,
                        bool is_above, double mu_low, double mu_high, double phi_low,
                        double phi_high) {
  // Pieces end at critical angles, where Fresnel's law has a square root.
  std::vector<double> ends{mu_low, mu_high};
  const double ior = is_above ? stack.ior_above : stack.ior_below;
  const auto end_at = [&](double other) {
    const double mu = other < ior ? std::sqrt(1.0 - other * other / (ior * ior)) : 0.0;
    if (mu_low < mu && mu < mu_high) ends.push_back(mu);
  };
  for (std::size_t k = 0; k < stack.layers.size(); ++k) end_at(stack.layers[k].ior);
  end_at(is_above ? stack.ior_below : stack.ior_above);
  std::sort(ends.begin(), ends.end());
  const Quadrature rule = gauss_legendre(12, 0.0, 1.0);
  const Quadrature phis = gauss_legendre(12, phi_low, phi_high);
  double sum = 0.0;
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece)
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
      for (std::size_t j = 0; j < phis.nodes.size(); ++j) {
        const double t = rule.nodes[i], width = ends[piece + 1] - ends[piece];
        const double mu = ends[piece] + width * t * t * (3.0 - 2.0 * t);  // crowded at both ends
        const double sine = std::sqrt(1.0 - mu * mu), phi = phis.nodes[j];
        const StackBeam<double> out =
            make_beam(stack, {-sine * std::cos(phi), -sine * std::sin(phi), is_above ? mu : -mu});
        sum += rule.weights[i] * 6.0 * t * (1.0 - t) * width * phis.weights[j] * mu *
               first_order_bsdf(stack, in, out);
      }
  const double mid = 0.5 * (mu_low + mu_high);
  return sum / ((mu_high - mu_low) * (phi_high - phi_low) * mid);
}

inline FirstOrderComparison compare_first_order(const FirstOrderCase& from, std::uint64_t photons,
                                                int cosines = 6, int azimuths = 4) {
  constexpr double pi = std::numbers::pi;
  const MonteCarloResult traced = trace_photons(
      from.stack,
      {.photons = photons,
       .seed = 5,
       .incidence = {.theta = from.theta_i},
       .tallies = {.bsdf_cosines = cosines, .bsdf_azimuths = azimuths, .orders = true}});
  const FirstOrderStack<double> stack = make_first_order(from.stack);
  const StackBeam<double> in =
      make_beam(stack, {std::sin(from.theta_i), 0.0, std::cos(from.theta_i)});
  FirstOrderComparison result;
  for (const bool is_above : {true, false}) {
    if (!is_above && !stack.is_transmissive()) continue;
    const auto& cells =
        is_above ? traced.bsdf_by_order.reflection : traced.bsdf_by_order.transmission;
    for (int i = 0; i < cosines; ++i)
      for (int j = 0; j < azimuths; ++j) {
        const Estimate& cell = cells[static_cast<std::size_t>((cosines + i) * azimuths + j)];
        const double expected =
            cell_mean(stack, in, is_above, double(i) / cosines, double(i + 1) / cosines,
                      2.0 * pi * j / azimuths, 2.0 * pi * (j + 1) / azimuths);
        const double z = (cell.value - expected) / cell.standard_error;
        result.worst = std::max(result.worst, std::abs(z));
        if (cell.value == 0.0) continue;  // no light gets there
        result.chi2 += z * z;
        result.relative_error += cell.standard_error / expected;
        ++result.cells;
      }
    const Estimate& flux =
        (is_above ? traced.by_order.reflection : traced.by_order.transmission)[1];
    result.worst_flux =
        std::max(result.worst_flux, std::abs(flux.value - first_order_flux(stack, in, is_above)) /
                                        flux.standard_error);
  }
  result.relative_error /= result.cells;
  return result;
}

}  // namespace lamina::reference
