// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/monte_carlo/internal/photon_exit_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/fresnel.h"

namespace lamina::photon {
namespace {

/// Straight rays of one direction through plane layers: cosines and transmittances of the layers,
/// Fresnel reflectances of the boundaries.
struct StraightRays {
  std::vector<double> mu;           ///< [layer], 0 where there is no such direction
  std::vector<double> pass;         ///< [layer] transmittance from boundary to boundary
  std::vector<double> reflectance;  ///< [boundary]
};

StraightRays make_straight_rays(const LayerStack& stack, double n_sin) {
  StraightRays rays;
  const std::size_t n = stack.layers().size();
  std::vector<double> ior = {stack.ior_above()};
  for (const Layer& layer : stack.layers()) ior.push_back(layer.medium.ior);
  ior.push_back(stack.ior_below());
  const auto cosine = [&](double index) {
    const double s = n_sin / index;
    return s < 1.0 ? std::sqrt(1.0 - s * s) : 0.0;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Layer& layer = stack.layers()[i];
    const double mu = cosine(layer.medium.ior);
    const double extinction = sigma_t(layer.medium);
    rays.mu.push_back(mu);
    rays.pass.push_back(std::isinf(layer.thickness) || mu == 0.0
                            ? 0.0
                            : std::exp(-extinction * layer.thickness / mu));
  }
  for (std::size_t i = 0; i <= n; ++i) {
    const double above = cosine(ior[i]), below = cosine(ior[i + 1]);
    rays.reflectance.push_back(above > 0.0 && below > 0.0 ? fresnel(above, ior[i + 1] / ior[i])
                                                          : 1.0);
  }
  if (is_semi_infinite(stack)) rays.reflectance.back() = 0.0;
  return rays;
}

}  // namespace

ExitView make_exit_view(const LayerStack& stack, const ExitDirection& direction) {
  if (!is_smooth(stack))
    throw InvalidInput("tallies: directions need smooth boundaries, but one is rough");
  const bool has_ground = stack.ground().reflectance > 0.0;
  if (direction.is_below && has_ground)
    throw InvalidInput("tallies: a direction below needs a black ground, but it reflects");
  const double n_out = direction.is_below ? stack.ior_below() : stack.ior_above();
  const double n_sin = n_out * std::sin(direction.theta);
  const StraightRays rays = make_straight_rays(stack, n_sin);
  const std::size_t n = stack.layers().size();

  // Light at a boundary goes through or is thrown back across its layer to the other one. The
  // balance is solved by following the light; what remains after a round shrinks geometrically.
  std::vector<double> up(n, 0.0), down(n, 0.0);
  const auto& f = rays.reflectance;
  for (int round = 0; round < 100'000; ++round) {
    double change = 0.0;
    const auto set = [&](double& value, double next) {
      change = std::max(change, std::abs(next - value));
      value = next;
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (rays.mu[i] == 0.0) continue;
      const double beyond = i > 0 ? rays.pass[i - 1] * up[i - 1] : direction.is_below ? 0.0 : 1.0;
      set(up[i], (1.0 - f[i]) * beyond + f[i] * rays.pass[i] * down[i]);
    }
    for (std::size_t i = n; i-- > 0;) {
      if (rays.mu[i] == 0.0) continue;
      const double beyond = i + 1 < n            ? rays.pass[i + 1] * down[i + 1]
                            : direction.is_below ? 1.0
                                                 : 0.0;
      set(down[i], (1.0 - f[i + 1]) * beyond + f[i + 1] * rays.pass[i] * up[i]);
    }
    if (change < 1e-14) break;
  }

  ExitView view;
  for (std::size_t i = 0; i < n; ++i) {
    const Medium& medium = stack.layers()[i].medium;
    const double mu = rays.mu[i], sine = n_sin / medium.ior;
    // Radiance outside over intensity inside: (n_out / n)^2 / mu, by the invariance of L / n^2.
    const double scale = mu > 0.0 ? n_out * n_out / (medium.ior * medium.ior * mu) : 0.0;
    view.ux.push_back(static_cast<float>(sine * std::cos(direction.phi)));
    view.uy.push_back(static_cast<float>(sine * std::sin(direction.phi)));
    view.mu.push_back(static_cast<float>(mu));
    view.from_top.push_back(static_cast<float>(scale * up[i]));
    view.from_bottom.push_back(static_cast<float>(scale * down[i]));
    view.decay.push_back(mu > 0.0 ? static_cast<float>(sigma_t(medium) / mu) : 0.0f);
  }
  if (has_ground) {
    const double n_ground = stack.ior_below();
    view.from_ground = static_cast<float>(n_out * n_out / (n_ground * n_ground * std::numbers::pi) *
                                          (1.0 - f[n]) * rays.pass[n - 1] * up[n - 1]);
  }
  return view;
}

}  // namespace lamina::photon
