// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/layers/optics/phase_function.h"

// A slow and literal photon Monte Carlo in double precision: one photon at a time, as the papers
// say it. It shares no code with the SIMD kernel but the stack's types, Fresnel's formula and the
// phase functions. Smooth boundaries, black ground, normal or oblique pencil beam.
//
// Source: [HanrahanKrueger1993] Figure 7; the turn of the direction and the boundaries as in
// [Wang1995] Eqs. 3.22-3.36.

namespace lamina::reference {

struct ScalarSum {
  double sum = 0.0, squares = 0.0;
  void add(double x) {
    sum += x;
    squares += x * x;
  }
  [[nodiscard]] double mean(double n) const { return sum / n; }
  [[nodiscard]] double standard_error(double n) const {
    return std::sqrt(std::max(0.0, squares / n - mean(n) * mean(n)) / n);
  }
};

struct ScalarPhotons {
  double photons = 0.0, events = 0.0;
  double specular_reflectance = 0.0;
  ScalarSum reflectance, transmittance, unscattered_transmittance;
  std::vector<ScalarSum> absorptance;           ///< [layer]
  std::vector<ScalarSum> radial, radial_below;  ///< [r] fractions
  std::vector<ScalarSum> angular;               ///< [angle] fractions
  std::vector<ScalarSum> order;                 ///< [0 .. 11] reflected, 11 is the rest
  std::vector<double> absorbed_rz;              ///< [r][depth] sums
  ScalarSum path_up;                            ///< weight times path
};

struct ScalarGrid {
  int radii = 10, angles = 10, depths = 10;
  double dr = 0.1, dz = 0.1;
};

[[nodiscard]] inline ScalarPhotons trace_scalar_photons(const LayerStack& stack, int photons,
                                                        std::uint64_t seed, double theta_i = 0.0,
                                                        const ScalarGrid& grid = {},
                                                        double roulette_weight = 0.1) {
  const auto layers = stack.layers();
  const int n = static_cast<int>(layers.size());
  const auto index = [](int i) { return static_cast<std::size_t>(i); };
  std::vector<double> top = {0.0};
  for (const Layer& layer : layers) top.push_back(top.back() + layer.thickness);
  const auto ior = [&](int layer) {
    return layer < 0    ? stack.ior_above()
           : layer >= n ? stack.ior_below()
                        : layers[index(layer)].medium.ior;
  };

  ScalarPhotons out;
  out.photons = photons;
  out.absorptance.resize(layers.size());
  out.radial.resize(index(grid.radii));
  out.radial_below.resize(index(grid.radii));
  out.angular.resize(index(grid.angles));
  out.order.resize(12);
  out.absorbed_rz.resize(index(grid.radii * grid.depths));
  const double eta0 = ior(0) / ior(-1);
  out.specular_reflectance = fresnel(std::cos(theta_i), eta0);

  for (int photon = 0; photon < photons; ++photon) {
    Random random = make_random(seed, static_cast<std::uint64_t>(photon));
    double x = 0.0, y = 0.0, z = 0.0;
    double ux = std::sin(theta_i) / eta0, uy = 0.0, uz = cos_refracted(std::cos(theta_i), eta0);
    double w = 1.0 - out.specular_reflectance, path = 0.0;
    int layer = 0, scatterings = 0;
    std::vector<double> absorbed(layers.size(), 0.0);
    while (w > 0.0) {
      out.events += 1.0;
      const Medium& medium = layers[index(layer)].medium;
      const double extinction = sigma_t(medium);
      const double step = extinction > 0.0 ? -std::log(1.0 - random.uniform()) / extinction : 1e30;
      double to_boundary = 1e300;
      if (uz > 0.0) to_boundary = (top[index(layer + 1)] - z) / uz;
      if (uz < 0.0) to_boundary = (top[index(layer)] - z) / uz;
      if (step < to_boundary) {
        x += ux * step, y += uy * step, z += uz * step, path += step;
        const double dw = w * medium.sigma_a / extinction;
        absorbed[index(layer)] += dw;
        w -= dw;
        const int ir =
            std::min(static_cast<int>(std::min(std::hypot(x, y) / grid.dr, 1e6)), grid.radii - 1);
        const int iz = std::min(static_cast<int>(std::min(z / grid.dz, 1e6)), grid.depths - 1);
        out.absorbed_rz[index(ir * grid.depths + iz)] += dw;
        ++scatterings;
        const double cos_theta = sample_cos_theta(phase_function(layers[index(layer)]),
                                                  random.uniform(), random.uniform());
        const double sin_theta = std::sqrt(std::max(0.0, 1.0 - cos_theta * cos_theta));
        const double phi = 2.0 * std::numbers::pi * random.uniform();
        const double cos_phi = std::cos(phi), sin_phi = std::sin(phi);
        if (std::abs(uz) > 0.99999) {
          ux = sin_theta * cos_phi, uy = sin_theta * sin_phi,
          uz = std::copysign(cos_theta, uz * cos_theta);
        } else {
          const double s = std::sqrt(1.0 - uz * uz);
          const double vx = sin_theta * (ux * uz * cos_phi - uy * sin_phi) / s + ux * cos_theta;
          const double vy = sin_theta * (uy * uz * cos_phi + ux * sin_phi) / s + uy * cos_theta;
          uz = -sin_theta * cos_phi * s + uz * cos_theta;
          ux = vx, uy = vy;
        }
        if (w < roulette_weight) {
          const double survivor = 2.0 * roulette_weight;
          const double kept = random.uniform() * survivor < w ? survivor : 0.0;
          absorbed[index(layer)] += w - kept;
          w = kept;
        }
        continue;
      }
      x += ux * to_boundary, y += uy * to_boundary, path += to_boundary;
      const int next = uz > 0.0 ? layer + 1 : layer - 1;
      z = uz > 0.0 ? top[index(layer + 1)] : top[index(layer)];
      const double eta = ior(next) / ior(layer);
      const double mu = std::min(std::abs(uz), 1.0);
      if (random.uniform() < fresnel(mu, eta)) {
        uz = -uz;
        continue;
      }
      ux /= eta, uy /= eta, uz = std::copysign(cos_refracted(mu, eta), uz);
      layer = next;
      if (layer >= 0 && layer < n) continue;
      const int ir =
          std::min(static_cast<int>(std::min(std::hypot(x, y) / grid.dr, 1e6)), grid.radii - 1);
      if (layer < 0) {
        out.reflectance.add(w);
        out.radial[index(ir)].add(w);
        const double angle = std::acos(std::min(std::abs(uz), 1.0)) / (0.5 * std::numbers::pi);
        out.angular[index(std::min(static_cast<int>(angle * grid.angles), grid.angles - 1))].add(w);
        out.order[index(std::min(scatterings, 11))].add(w);
        out.path_up.add(w * path);
      } else {
        out.transmittance.add(w);
        out.radial_below[index(ir)].add(w);
        if (scatterings == 0) out.unscattered_transmittance.add(w);
      }
      w = 0.0;
    }
    for (std::size_t i = 0; i < absorbed.size(); ++i) out.absorptance[i].add(absorbed[i]);
  }
  return out;
}

}  // namespace lamina::reference
