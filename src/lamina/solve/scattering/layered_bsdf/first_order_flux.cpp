// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "lamina/base/core/quadrature.h"
#include "lamina/solve/scattering/layered_bsdf/internal/first_order-inl.h"

namespace lamina {
namespace {

using namespace first_order::HWY_NAMESPACE;

/// Mean of the phase function over azimuth, for cosines cos_theta = a + b cos(phi).
///
/// Of Henyey-Greenstein's it is a complete elliptic integral: that of (A - B cos phi)^-3/2 over a
/// turn is 4 E(k) / ((A - B) sqrt(A + B)) with k^2 = 2B / (A + B).
double mean_phase(const FirstOrderStack<double>& stack, const FirstOrderLayer<double>& layer,
                  double a, double b) {
  double sum = 0.0;
  for (std::size_t l = layer.first_lobe; l < layer.first_lobe + layer.lobes; ++l) {
    const PhaseLobe<double>& lobe = stack.lobes[l];
    if (lobe.is_rayleigh) {
      sum += lobe.weight * 0.75 * (1.0 + a * a + 0.5 * b * b);
      continue;
    }
    const double A = 1.0 + lobe.g * lobe.g - 2.0 * lobe.g * a, B = std::abs(2.0 * lobe.g * b);
    const double k = std::sqrt(2.0 * B / (A + B));
    sum += lobe.weight * (1.0 - lobe.g * lobe.g) * 2.0 * std::numbers::inv_pi *
           std::comp_ellint_2(std::min(k, 1.0)) / ((A - B) * std::sqrt(A + B));
  }
  return 0.25 * std::numbers::inv_pi * sum;
}

}  // namespace

double mean_first_order_bsdf(const FirstOrderStack<double>& stack, const StackBeam<double>& in,
                             const StackBeam<double>& out) {
  double sum = 0.0;
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    const FirstOrderLayer<double>& layer = stack.layers[k];
    const Turns<double> turn = turns(layer, in.layers[k], out.layers[k], false);
    if (!(turn.back + turn.on > 0.0)) continue;
    const double mu_in = in.layers[k].mu, mu_out = out.layers[k].mu;
    const double cosines = mu_in * mu_out;
    const double across = std::sqrt((1.0 - mu_in * mu_in) * (1.0 - mu_out * mu_out));
    sum += turn.back * mean_phase(stack, layer, -cosines, across) +
           turn.on * mean_phase(stack, layer, cosines, across);
  }
  if (stack.has_ground)
    sum += std::numbers::inv_pi * stack.ground_reflectance * in.ground * out.ground /
           (stack.ior_below * stack.ior_below);
  return out.ior * out.ior * sum;
}

double first_order_flux(const FirstOrderStack<double>& stack, const StackBeam<double>& in,
                        bool is_same_side) {
  const bool is_above = (in.toward.z >= 0.0) == is_same_side;
  if (!is_above && !stack.is_transmissive()) return 0.0;
  const double ior = is_above ? stack.ior_above : stack.ior_below;
  // Pieces end at forward peaks, where Snell's law makes the directions one inside, and at critical
  // angles; nodes crowd at both ends of each.
  std::vector<double> ends{0.0, 1.0};
  const auto end_at_sine = [&](double sine) {
    if (sine < 1.0) ends.push_back(std::sqrt(1.0 - sine * sine));
  };
  end_at_sine(in.ior / ior * std::sqrt(1.0 - in.mu * in.mu));
  for (std::size_t k = 0; k < stack.layers.size(); ++k) end_at_sine(stack.layers[k].ior / ior);
  end_at_sine((is_above ? stack.ior_below : stack.ior_above) / ior);
  std::sort(ends.begin(), ends.end());

  static const Quadrature rule = gauss_legendre(24, 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double low = ends[piece], width = ends[piece + 1] - low;
    if (width < 1e-12) continue;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double t = rule.nodes[i];
      const double mu = std::min(low + width * t * t * (3.0 - 2.0 * t), 1.0);
      const double weight = 6.0 * t * (1.0 - t) * width * rule.weights[i];
      const double sine = std::sqrt(1.0 - mu * mu);
      const StackBeam<double> out = make_beam(stack, {sine, 0.0, is_above ? mu : -mu});
      sum += weight * mu * mean_first_order_bsdf(stack, in, out);
    }
  }
  return 2.0 * std::numbers::pi * sum;
}

}  // namespace lamina
