// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "lamina/scattering/first_order.h"
#include "lamina/scattering/higher_orders.h"

namespace lamina {

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

/// higher_orders_bsdf for all bands; what crosses the boundaries is left to the caller, who
/// multiplies by (1 - surface) of both beams.
template <int N>
[[nodiscard]] BandValues<N> higher_orders_inside(const HigherOrderBands<N>& orders,
                                                 const StackBeam<BandValues<N>>& in,
                                                 const StackBeam<BandValues<N>>& out);

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

  struct Value {
    Bands bsdf;        ///< radiance to wo per irradiance from wi [1/sr]
    float pdf = 0.0f;  ///< of sample() [1/sr]
    Bands surface;     ///< reflectance of the boundary that light from wi meets
  };
  /// @param wi  unit vector towards the light; the other side than wo's only if the stack
  /// transmits.
  [[nodiscard]] Value evaluate(const Vec3& wi) const;

  struct Sample {
    Vec3 wi;
    Value value;  ///< pdf 0: nothing was drawn
  };
  /// Draws a direction: over the cosine, or by a phase function inside and refracted out. Where
  /// that does not get out nothing is drawn, so that the density may sum to less than 1.
  ///
  /// @param u  uniform in [0, 1)
  [[nodiscard]] Sample sample(float u, float u1, float u2) const;

  /// Radiance to wo by mirrors below the surface, per radiance from the mirror direction.
  [[nodiscard]] const Bands& mirrored_inside() const { return mirrored_inside_; }
  [[nodiscard]] const StackBeam<Bands>& beam() const { return out_; }

 private:
  /// A layer's phase function, as it is drawn from.
  struct Lobe {
    float chance = 0.0f;  ///< of this layer
    float g = 0.0f;
    float mu = 1.0f;     ///< cosine of wo inside
    float ratio = 1.0f;  ///< index of wo's side over the layer's
  };
  [[nodiscard]] Value evaluate(const StackBeam<Bands>& in) const;
  [[nodiscard]] float pdf(const StackBeam<Bands>& in) const;
  [[nodiscard]] Vec3 draw_by_phase(float u, float u1, float u2) const;

  const FirstOrderStack<Bands>& stack_;
  const HigherOrderBands<N>* higher_;
  StackBeam<Bands> out_;
  Bands mirrored_inside_;
  InlineVector<Lobe, 4> lobes_;
  float same_chance_ = 1.0f, other_chance_ = 0.0f, phase_chance_ = 0.0f;
};

}  // namespace lamina
