// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/diffusion/pulsed_diffusion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/speed_of_light.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/pulsed_dipole.h"

namespace lamina {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// Before this part of the time that light needs nothing can be measured.
constexpr double earliest = 0.3;
constexpr double least_of_peak = 1e-8;

/// A layer as diffusion sees it; the source stands between two of them.
struct DiffuseLayer {
  double D, speed, sigma_a, thickness, ior;
};

struct DiffuseLayers {
  std::vector<DiffuseLayer> layers;
  std::size_t source = 0;  ///< the layer below it
  double z_b = 0.0;        ///< height above the surface where the fluence vanishes [mm]
  EscapeWeights escape;
  double leak = 0.0;  ///< flux over fluence at an open lower side
  double entered = 1.0;

  /// The slowest decay of a layer [1/ps].
  [[nodiscard]] double least_decay() const {
    double least = layers[0].sigma_a * layers[0].speed;
    for (const DiffuseLayer& layer : layers) least = std::min(least, layer.sigma_a * layer.speed);
    return least;
  }
};

void check_scattering(const LayerStack& stack) {
  for (std::size_t i = 0; i < stack.layers().size(); ++i)
    if (!(sigma_s_prime(stack.layers()[i].medium) > 0.0))
      throw InvalidInput("layer " + std::to_string(i) +
                         ": diffusion requires sigma_s > 0 [1/mm], but is " +
                         number_text(stack.layers()[i].medium.sigma_s));
}

DiffuseLayers make_diffuse_layers(const LayerStack& stack) {
  DiffuseLayers all;
  double depth = 1.0;  // of the source, in reduced mean free paths, from here on
  for (const Layer& layer : stack.layers()) {
    const double scattering = sigma_s_prime(layer.medium), above = depth / scattering;
    DiffuseLayer part{1.0 / (3.0 * scattering), speed_of_light / layer.medium.ior,
                      layer.medium.sigma_a, layer.thickness, layer.medium.ior};
    if (all.source == 0 && above < layer.thickness) {
      part.thickness = above;
      all.layers.push_back(part);
      all.source = all.layers.size();
      part.thickness = layer.thickness - above;
    }
    depth -= scattering * layer.thickness;
    all.layers.push_back(part);
  }
  if (all.source == 0) {  // a thin slab: half way through its last layer
    all.layers.back().thickness *= 0.5;
    all.source = all.layers.size();
    all.layers.push_back(DiffuseLayer(all.layers.back()));
  }
  const Layer &first = stack.layers().front(), &last = stack.layers().back();
  all.escape = make_escape_weights(first.top, first.medium.ior, stack.ior_above());
  all.z_b = 2.0 * all.escape.fluence_ratio() * all.layers[0].D;
  all.entered = entry_transmittance(stack, {});
  if (is_semi_infinite(stack)) return all;
  // What the lower boundary turns back, or a ground below it.
  const double inside = diffuse_reflectance_inside(stack.ground().top, last.medium.ior,
                                                   stack.ior_below(), DiffuseFresnel::exact);
  const double outside =
      diffuse_reflectance_outside(stack.ground().top, stack.ior_below(), last.medium.ior);
  const double rho = stack.ground().reflectance;
  const double f = inside + (1.0 - inside) * rho * (1.0 - outside) / (1.0 - rho * outside);
  all.leak = 0.5 * (1.0 - f) / (1.0 + f);
  return all;
}

/// (1 - exp(-2 x)) / (1 + exp(-2 x))
Complex tanh_of(Complex x) {
  const Complex e = std::exp(-2.0 * x);
  return (1.0 - e) / (1.0 + e);
}

/// What leaves of a unit pulse, at spatial frequency k and rate s.
Complex response_at(const DiffuseLayers& all, double k, Complex s) {
  const auto& layers = all.layers;
  const std::size_t n = layers.size();
  const auto decay_of = [&](const DiffuseLayer& layer) {
    return std::sqrt(k * k + (layer.sigma_a + s / layer.speed) / layer.D);
  };
  const auto ratio = [](const DiffuseLayer& of, const DiffuseLayer& over) {
    return of.ior * of.ior / (over.ior * over.ior);
  };
  // Flux over fluence through a layer from the other end, where it is `end`.
  const auto through = [](Complex end, Complex stiffness, Complex turn) {
    return stiffness * (end + stiffness * turn) / (stiffness + end * turn);
  };
  // Downward flux over fluence, from below to the source.
  Complex down = all.leak;
  for (std::size_t i = n; i-- > all.source;) {
    const Complex decay = decay_of(layers[i]), stiffness = layers[i].D * decay;
    down = std::isinf(layers[i].thickness)
               ? stiffness
               : through(down, stiffness, tanh_of(decay * layers[i].thickness));
    down *= ratio(layers[i], layers[i - 1]);
  }
  // Upward flux over fluence from the surface to the source, and how the fluence grows with it.
  const Complex first = decay_of(layers[0]);
  const Complex at_surface = layers[0].D * first / tanh_of(first * all.z_b);
  Complex up = at_surface, shrunk = 1.0;
  for (std::size_t i = 0; i < all.source; ++i) {
    if (i > 0) {
      up *= ratio(layers[i - 1], layers[i]);
      shrunk *= ratio(layers[i - 1], layers[i]);
    }
    const Complex decay = decay_of(layers[i]), stiffness = layers[i].D * decay;
    const Complex straight = std::exp(-decay * layers[i].thickness), q = up / stiffness;
    shrunk *= 2.0 * straight / ((1.0 + q) + (1.0 - q) * straight * straight);
    up = through(up, stiffness, tanh_of(decay * layers[i].thickness));
  }
  const Complex fluence = shrunk / (up + down);
  return fluence * (all.escape.fluence + all.escape.flux * at_surface);
}

/// A path of rates around all singularities, which lie on the negative axis, for times from a first
/// one to `window` times it.
struct RatePath {
  static constexpr double window = 5.0;
  std::vector<Complex> rate, weight;  ///< f(t) = sum of Re(weight exp(rate t) F(rate))
};

RatePath make_rate_path(double first_time) {
  constexpr int nodes = 16;
  constexpr double angle = 1.07;  // the best for such a window: error exp(-1.25 nodes)
  constexpr double w = RatePath::window;
  const double a = std::acosh(((pi - 2.0 * angle) * w + 4.0 * angle - pi) /
                              ((4.0 * angle - pi) * std::sin(angle)));
  const double h = a / nodes;
  const double scale = (4.0 * pi * angle - pi * pi) / a * nodes / (w * first_time);
  RatePath path;
  for (int i = 0; i < nodes; ++i) {
    const Complex u{-angle, (i + 0.5) * h};
    path.rate.push_back(scale * (1.0 + std::sin(u)));
    path.weight.push_back(scale * h / pi * std::cos(u));  // of both halves
  }
  return path;
}

/// R(r, t) of some times within a window [r][t], without the slowest decay.
std::vector<std::vector<double>> in_window(const DiffuseLayers& all, std::span<const double> r,
                                           std::span<const double> t) {
  const RatePath path = make_rate_path(t.front());
  std::vector<Complex> growth;  // [rate][t]
  for (std::size_t i = 0; i < path.rate.size(); ++i)
    for (const double time : t) growth.push_back(path.weight[i] * std::exp(path.rate[i] * time));
  const double decay = all.least_decay();
  double slowest = all.layers[0].D * all.layers[0].speed;
  for (const DiffuseLayer& layer : all.layers) slowest = std::min(slowest, layer.D * layer.speed);
  // Waves beyond have died out at the first time.
  const double k_end = std::sqrt(40.0 / (slowest * t.front()));
  const double farthest = *std::ranges::max_element(r);
  const Quadrature waves =
      gauss_legendre(32 + static_cast<int>(std::ceil(0.6 * k_end * farthest)), 0.0, k_end);
  std::vector<std::vector<double>> sums(r.size(), std::vector<double>(t.size(), 0.0));
  for (std::size_t q = 0; q < waves.nodes.size(); ++q) {
    const double k = waves.nodes[q];
    std::vector<double> over_time(t.size(), 0.0);
    for (std::size_t i = 0; i < path.rate.size(); ++i) {
      const Complex value = response_at(all, k, path.rate[i] - decay);
      for (std::size_t j = 0; j < t.size(); ++j)
        over_time[j] += (growth[i * t.size() + j] * value).real();
    }
    for (std::size_t d = 0; d < r.size(); ++d) {
      const double weight = waves.weights[q] * k * std::cyl_bessel_j(0.0, k * r[d]) / (2.0 * pi);
      for (std::size_t j = 0; j < t.size(); ++j) sums[d][j] += weight * over_time[j];
    }
  }
  return sums;
}

/// When light can be at a distance at the earliest, by its fastest layer.
double first_time(const LayerStack& stack, double r) {
  double ior = stack.layers()[0].medium.ior;
  for (const Layer& layer : stack.layers()) ior = std::min(ior, layer.medium.ior);
  return earliest * r * ior / speed_of_light;
}

/// Too little, and times too early, become the least that is resolved.
void raise_to_resolved(const LayerStack& stack, std::span<const double> r,
                       std::span<const double> t, std::vector<std::vector<double>>& values) {
  for (std::size_t d = 0; d < r.size(); ++d) {
    double most = 1e-290;
    for (std::size_t j = 0; j < t.size(); ++j) {
      if (t[j] <= first_time(stack, r[d])) values[d][j] = 0.0;
      most = std::max(most, values[d][j]);
    }
    for (double& value : values[d]) value = std::max(value, least_of_peak * most);
  }
}

}  // namespace

std::vector<std::vector<double>> pulsed_diffusion_by_transforms(const LayerStack& stack,
                                                                std::span<const double> r,
                                                                std::span<const double> t) {
  check_scattering(stack);
  const DiffuseLayers all = make_diffuse_layers(stack);
  const double nearest = *std::ranges::min_element(r);
  std::vector<std::size_t> order(t.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t j) { return t[j]; });
  std::erase_if(order, [&](std::size_t j) { return t[j] <= first_time(stack, nearest); });
  std::vector<std::vector<double>> values(r.size(), std::vector<double>(t.size(), 0.0));
  for (std::size_t first = 0; first < order.size();) {
    std::vector<double> window;
    for (std::size_t i = first;
         i < order.size() && t[order[i]] <= RatePath::window * t[order[first]]; ++i)
      window.push_back(t[order[i]]);
    const auto part = in_window(all, r, window);
    for (std::size_t d = 0; d < r.size(); ++d)
      for (std::size_t i = 0; i < window.size(); ++i)
        values[d][order[first + i]] =
            all.entered * part[d][i] * std::exp(-all.least_decay() * window[i]);
    first += window.size();
  }
  raise_to_resolved(stack, r, t, values);
  return values;
}

std::vector<std::vector<double>> pulsed_diffusion(const LayerStack& stack,
                                                  std::span<const double> r,
                                                  std::span<const double> t) {
  if (stack.layers().size() > 1 || !is_semi_infinite(stack))
    return pulsed_diffusion_by_transforms(stack, r, t);
  check_scattering(stack);
  const PulsedDipole dipole = make_pulsed_dipole(stack.layers()[0], stack.ior_above());
  const double entered = entry_transmittance(stack, {});
  std::vector<std::vector<double>> values(r.size());
  for (std::size_t d = 0; d < r.size(); ++d)
    for (const double time : t)
      values[d].push_back(entered * pulsed_reflectance(dipole, r[d], time));
  raise_to_resolved(stack, r, t, values);
  return values;
}

}  // namespace lamina
