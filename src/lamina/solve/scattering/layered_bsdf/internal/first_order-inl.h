// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// The parts of the first-order formulas that are shared by their files; included once per
// instruction set. They take stacks and beams of S = double or BandValues<N>, and compute with V =
// double or BandLanes<N>.

#if defined(LAMINA_FIRST_ORDER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_FIRST_ORDER_INL_H
#undef LAMINA_FIRST_ORDER_INL_H
#else
#define LAMINA_FIRST_ORDER_INL_H
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "lamina/solve/scattering/layered_bsdf/first_order.h"
#include "lamina/solve/scattering/layered_bsdf/internal/band_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::first_order::HWY_NAMESPACE {

inline double lanes_of(double x) { return x; }
inline void store(double from, double& to) { to = from; }
template <int N>
HWY_INLINE BandLanes<N> lanes_of(const BandValues<N>& x) {
  return x;
}
/// V for S.
template <class S>
using LanesOf = decltype(lanes_of(S{}));

/// The number in all lanes.
template <class V>
HWY_INLINE V all(double x) {
  if constexpr (std::is_same_v<V, double>)
    return x;
  else
    return V::filled(static_cast<float>(x));
}

template <class S>
HWY_INLINE LayerBeam<LanesOf<S>> lanes_of(const LayerBeam<S>& beam) {
  return {.mu = beam.mu,
          .inverse_mu = beam.inverse_mu,
          .decay = beam.decay,
          .pass = beam.pass,
          .down = beam.down,
          .up = beam.up};
}

inline double exp_minus(double x) { return std::exp(-x); }
inline double reciprocal(double x) { return 1.0 / x; }
inline double reciprocal_root(double x) { return 1.0 / std::sqrt(x); }
using std::abs, std::max, std::min, std::sqrt;

/// Integral of exp(-(a + b) z) over the layer, for the decays a and b of two beams.
inline double along(const LayerBeam<double>& in, const LayerBeam<double>& out, double thickness) {
  const double x = (in.decay + out.decay) * thickness;
  return thickness * (x > 0.0 ? -std::expm1(-x) / x : 1.0);
}

/// Integral of exp(-a z) exp(-b (d - z)): l'Hospital's limit is its middle.
inline double against(const LayerBeam<double>& in, const LayerBeam<double>& out, double thickness) {
  const double x = std::abs(in.decay - out.decay) * thickness;
  return thickness * std::max(in.pass, out.pass) * (x > 0.0 ? -std::expm1(-x) / x : 1.0);
}

/// (1 - exp(-x)) / x for 0 <= x <= 1/2, where the difference would cancel; `direct` beyond.
template <class V>
HWY_INLINE V mean_attenuation(const V& x, const V& direct) {
  V p = (1.0f / 5040.0f) * x;
  for (const float coefficient : {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f})
    p = x * (V::filled(coefficient) - p);
  return where_less(x, 0.5f, V::filled(1.0f) - p, direct);
}
template <class V>
HWY_INLINE V along(const LayerBeam<V>& in, const LayerBeam<V>& out, const V& thickness) {
  const V x = min((in.decay + out.decay) * thickness, V::filled(1e30f));
  const V half = V::filled(0.5f);
  const V lost = half + half - in.pass * out.pass;
  return thickness * mean_attenuation(x, lost * reciprocal(max(x, half)));
}
template <class V>
HWY_INLINE V against(const LayerBeam<V>& in, const LayerBeam<V>& out, const V& thickness) {
  const V x = min(abs(in.decay - out.decay) * thickness, V::filled(1e30f));
  const V high = max(in.pass, out.pass), low = min(in.pass, out.pass);
  const V half = V::filled(0.5f);
  return thickness * where_less(x, 0.5f, high * mean_attenuation(x, half),
                                (high - low) * reciprocal(max(x, half)));
}

/// Unpolarized reflectance of a smooth boundary by the cosines on both sides; 0 marks the side on
/// which the light cannot be. Source: [BornWolf1999] §1.5.2, Eq. 21.
template <class V>
HWY_INLINE V boundary_reflectance(const V& ior_a, const V& mu_a, const V& ior_b, const V& mu_b) {
  const auto square = [](const V& x) { return x * x; };
  const V s_a = ior_a * mu_a, s_b = ior_b * mu_b, p_a = ior_b * mu_a, p_b = ior_a * mu_b;
  const V of_s = square(s_a + s_b), of_p = square(p_a + p_b);
  // (r_s^2 + r_p^2) / 2 over one denominator; both cosines may be 0.
  return (square(s_a - s_b) * of_p + square(p_a - p_b) * of_s) *
         reciprocal(all<V>(2.0) * of_s * of_p + all<V>(1e-36));
}

/// Densities of a layer's scattering over the sphere [1/sr], where it turns light by angles of
/// these 1 - cos.
template <class S, class V, std::size_t Count>
HWY_INLINE std::array<V, Count> phases(const FirstOrderStack<S>& stack,
                                       const FirstOrderLayer<S>& layer,
                                       const std::array<V, Count>& one_minus_cos) {
  constexpr double inverse_4pi = 0.25 * std::numbers::inv_pi;
  const V one = all<V>(1.0);
  std::array<V, Count> sums;
  sums.fill(all<V>(0.0));
  for (std::size_t l = layer.first_lobe; l < layer.first_lobe + layer.lobes; ++l) {
    const PhaseLobe<S>& lobe = stack.lobes[l];
    if (lobe.is_rayleigh) {
      const V weight = all<V>(0.75 * inverse_4pi) * lobe.weight;
      for (std::size_t i = 0; i < Count; ++i) {
        const V cosine = one - one_minus_cos[i];
        sums[i] += weight * (one + cosine * cosine);
      }
      continue;
    }
    const V g = lobe.g, off = one - g;
    const V weight = all<V>(inverse_4pi) * lobe.weight * off * (one + g);
    for (std::size_t i = 0; i < Count; ++i) {  // as henyey_greenstein.h
      const V r = reciprocal_root(off * off + (g + g) * one_minus_cos[i]);
      sums[i] += weight * (r * r * r);
    }
  }
  return sums;
}

/// Turns of the two beams at the event: factors of the phase function for light that turns
/// back, and for light that goes on into the same hemisphere.
template <class V>
struct Turns {
  V back, on;
  bool has_on = true;
};

template <class S, class V>
HWY_INLINE Turns<V> turns(const FirstOrderLayer<S>& layer, const LayerBeam<V>& in,
                          const LayerBeam<V>& out, bool are_above) {
  const V thickness = layer.thickness;
  const V factor = V(layer.sigma_s) * layer.inverse_ior2 * in.inverse_mu * out.inverse_mu;
  const V back = factor * along(in, out, thickness);
  // Two beams from above with nothing below that reflects: both go down, and light can but turn.
  if (are_above && layer.is_matched_on_below)
    return {.back = back * in.down * out.down, .on = all<V>(0.0), .has_on = false};
  return {.back = back * (in.down * out.down + in.up * out.up),
          .on = factor * (in.down * out.up + in.up * out.down) * against(in, out, thickness)};
}

}  // namespace lamina::first_order::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
