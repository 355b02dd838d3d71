// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/solve/scattering/layered_bsdf/internal/sampled_layers-inl.h"
#include "lamina/solve/scattering/layered_bsdf/internal/sampled_layers_kernels.h"

namespace lamina {

template <int N>
HigherOrderBands<N> make_higher_order_bands(std::span<const HigherOrders> bands) {
  assert(!bands.empty());
  HigherOrderBands<N> made;
  for (int lane = 0; lane < N; ++lane) {
    const HigherOrders& from = bands[std::min(static_cast<std::size_t>(lane), bands.size() - 1)];
    const auto set = [&](auto& to, const HigherOrders::Row& row) {
      for (std::size_t i = 0; i < row.size(); ++i) to[i][lane] = static_cast<float>(row[i]);
    };
    set(made.above, from.above);
    set(made.below, from.below);
    set(made.down, from.down);
    set(made.up, from.up);
    set(made.reflected, from.reflected);
    set(made.transmitted, from.transmitted);
    made.mean_above[lane] = static_cast<float>(from.mean_above);
    made.mean_below[lane] = static_cast<float>(from.mean_below);
    made.mean_through[lane] = static_cast<float>(from.mean_through);
  }
  return made;
}

template <int N>
BandValues<N> value_at(const std::array<BandValues<N>, HigherOrders::angles>& row, float mu) {
  return BandValues<N>(sampled_layers::HWY_NAMESPACE::value_in(row, mu));
}

template <int N>
SampledLayers<N>::SampledLayers(const FirstOrderStack<Bands>& stack,
                                const HigherOrderBands<N>* higher, const Vec3& wo)
    : kernels_(&sampled_layers_kernels<N>()) {
  kernels_->look(stack, higher, wo, seen_);
}

template <int N>
LayersValue<N> SampledLayers<N>::evaluate(const Vec3& wi) const {
  Value value;
  kernels_->evaluate(seen_, wi, value);
  return value;
}

template <int N>
LayersSample<N> SampledLayers<N>::sample(float u, float u1, float u2) const {
  Sample drawn;
  kernels_->sample(seen_, u, u1, u2, drawn);
  return drawn;
}

#define LAMINA_SAMPLED_LAYERS(N)                                                                  \
  template HigherOrderBands<N> make_higher_order_bands<N>(std::span<const HigherOrders>);         \
  template BandValues<N> value_at(const std::array<BandValues<N>, HigherOrders::angles>&, float); \
  template class SampledLayers<N>;
LAMINA_SAMPLED_LAYERS(4)
LAMINA_SAMPLED_LAYERS(8)
LAMINA_SAMPLED_LAYERS(16)
#undef LAMINA_SAMPLED_LAYERS

}  // namespace lamina
