// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "lamina/solve/scattering/layered_bsdf/first_order.h"
#include "lamina/solve/scattering/layered_bsdf/higher_orders.h"

namespace lamina {

template <int N>
struct SampledLayersKernels;

/// HigherOrders of the bands of a pass, side by side.
template <int N>
struct HigherOrderBands {
  using Bands = BandValues<N>;
  using Row = std::array<Bands, HigherOrders::angles>;
  Row above{}, below{}, down{}, up{};
  Row reflected{}, transmitted{};  ///< light of all orders from above, over what entered
  Bands mean_above, mean_below, mean_through;
};

/// Lanes beyond the bands repeat the last.
template <int N>
[[nodiscard]] HigherOrderBands<N> make_higher_order_bands(std::span<const HigherOrders> bands);

/// A row's value at a cosine outside.
template <int N>
[[nodiscard]] BandValues<N> value_at(const std::array<BandValues<N>, HigherOrders::angles>& row,
                                     float mu);

/// A layer's phase function, as it is drawn from.
struct LobeSeen {
  float chance = 0.0f;  ///< of this layer
  float g = 0.0f;
  float mu = 1.0f;     ///< cosine of wo inside
  float ratio = 1.0f;  ///< index of wo's side over the layer's
  float inverse_ior = 1.0f;
};

/// Values of a stack that depend on the direction of the eye.
template <int N>
struct LayersSeen {
  using Bands = BandValues<N>;
  const FirstOrderStack<Bands>* stack = nullptr;
  const HigherOrderBands<N>* higher = nullptr;
  StackBeam<Bands> out;
  Bands higher_same, higher_other;  ///< factors of the higher orders, for light from either side
  InlineVector<LobeSeen, 4> lobes;
  float same_chance = 1.0f, other_chance = 0.0f, phase_chance = 0.0f;
};

template <int N>
struct LayersValue {
  BandValues<N> bsdf;     ///< radiance to wo per irradiance from wi [1/sr]
  float pdf = 0.0f;       ///< of sample() [1/sr]
  BandValues<N> surface;  ///< reflectance of the boundary that light from wi meets
};

template <int N>
struct LayersSample {
  Vec3 wi;
  LayersValue<N> value;  ///< pdf 0: nothing was drawn
};

/// How a layer stack scatters light to one direction: all orders, as a BSDF that can be sampled.
/// The stack and the orders must outlive it.
template <int N>
class SampledLayers {
 public:
  using Bands = BandValues<N>;

  /// @param wo  unit vector towards the eye; z < 0 is below the stack, if that transmits.
  /// @param higher  null: the first order alone.
  SampledLayers(const FirstOrderStack<Bands>& stack, const HigherOrderBands<N>* higher,
                const Vec3& wo);

  using Value = LayersValue<N>;
  using Sample = LayersSample<N>;
  /// @param wi  unit vector towards the light; the other side than wo's only if the stack
  /// transmits.
  [[nodiscard]] Value evaluate(const Vec3& wi) const;

  /// Draws a direction: over the cosine, or by a phase function inside and refracted out. Where
  /// that does not get out nothing is drawn, so that the density may sum to less than 1.
  ///
  /// @param u  uniform in [0, 1)
  [[nodiscard]] Sample sample(float u, float u1, float u2) const;

  /// Radiance to wo by mirrors below the surface, per radiance from the mirror direction.
  [[nodiscard]] Bands mirrored_inside() const {
    return max(seen_.out.reflected - seen_.out.surface, Bands{});
  }
  [[nodiscard]] const StackBeam<Bands>& beam() const { return seen_.out; }

 private:
  const SampledLayersKernels<N>* kernels_;
  LayersSeen<N> seen_;
};

}  // namespace lamina
