// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/profiles/once_in_even_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {
namespace {

Vec3 towards(double mu) { return {std::sqrt(1.0 - mu * mu), 0.0, mu}; }

/// One index for all layers, smooth boundaries, nothing below.
LayerStack matched_inside(const LayerStack& stack) {
  std::vector<Layer> layers(stack.layers().begin(), stack.layers().end());
  const double ior = layers.front().medium.ior;
  for (Layer& layer : layers) {
    layer.medium.ior = ior;
    layer.top = {};
  }
  return LayerStack(std::move(layers), stack.ior_above(), ior);
}

}  // namespace

template <int N>
OnceInEvenLight<N>::OnceInEvenLight(std::span<const LayerStack> stacks) {
  const Quadrature rule = gauss_legendre(24, 0.0, 1.0);
  for (std::size_t band = 0; band < stacks.size(); ++band) {
    const LayerStack layers = matched_inside(stacks[band]);
    const auto stack = make_first_order(layers, InternalReflections::lost);
    const double eta = layers.layers().front().medium.ior / layers.ior_above();
    for (int node = 0; node < nodes; ++node) {
      const double mu = std::max(static_cast<double>(node) / (nodes - 1), 1e-3);
      const auto out = make_beam(stack, towards(mu));
      double radiance = 0.0;
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const auto in = make_beam(stack, towards(rule.nodes[i]));
        radiance += 2.0 * std::numbers::pi * rule.weights[i] * rule.nodes[i] *
                    mean_first_order_bsdf(stack, in, out);
      }
      shares_[static_cast<std::size_t>(node)][static_cast<int>(band)] =
          static_cast<float>(radiance / (1.0 - fresnel(mu, eta)));
    }
  }
}

template <int N>
BandValues<N> OnceInEvenLight<N>::share(float cos_o) const {
  const float place = std::clamp(cos_o, 0.0f, 0.999999f) * (nodes - 1);
  const auto i = static_cast<std::size_t>(place);
  return shares_[i] + (place - static_cast<float>(i)) * (shares_[i + 1] - shares_[i]);
}

template <int N>
BandValues<N> OnceInEvenLight<N>::largest_share() const {
  BandValues<N> most;
  for (const BandValues<N>& share : shares_) most = max(most, share);
  return most;
}

template class OnceInEvenLight<4>;
template class OnceInEvenLight<8>;
template class OnceInEvenLight<16>;

}  // namespace lamina
