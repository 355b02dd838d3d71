// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of the first-order formulas that are shared by their files: lane by lane arithmetic for
// V = double and V = BandValues<N>.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "lamina/scattering/layered_bsdf/first_order.h"

namespace lamina::first_order {

[[nodiscard]] inline double fill(double x, const double*) { return x; }
[[nodiscard]] inline float fill(double x, const float*) { return static_cast<float>(x); }
template <int N>
[[nodiscard]] BandValues<N> fill(double x, const BandValues<N>*) {
  return BandValues<N>::filled(static_cast<float>(x));
}
/// The number in all lanes.
template <class V>
[[nodiscard]] V all(double x) {
  return fill(x, static_cast<const V*>(nullptr));
}

[[nodiscard]] inline double exp_minus(double x) { return std::exp(-x); }
[[nodiscard]] inline double reciprocal(double x) { return 1.0 / x; }
[[nodiscard]] inline double reciprocal_root(double x) { return 1.0 / std::sqrt(x); }
using lamina::abs, lamina::max, lamina::min, lamina::sqrt, lamina::exp_minus;
using lamina::reciprocal, lamina::reciprocal_root;
using std::abs, std::max, std::min, std::sqrt;

/// Integral of exp(-(a + b) z) over the layer, for the decays a and b of two beams.
[[nodiscard]] inline double along(const LayerBeam<double>& in, const LayerBeam<double>& out,
                                  double thickness) {
  const double x = (in.decay + out.decay) * thickness;
  return thickness * (x > 0.0 ? -std::expm1(-x) / x : 1.0);
}

/// Integral of exp(-a z) exp(-b (d - z)): l'Hospital's limit is its middle.
[[nodiscard]] inline double against(const LayerBeam<double>& in, const LayerBeam<double>& out,
                                    double thickness) {
  const double x = std::abs(in.decay - out.decay) * thickness;
  return thickness * std::max(in.pass, out.pass) * (x > 0.0 ? -std::expm1(-x) / x : 1.0);
}

/// (1 - exp(-x)) / x for 0 <= x <= 1/2, where the difference would cancel; `direct` beyond.
template <int N>
[[nodiscard]] BandValues<N> mean_attenuation(const BandValues<N>& x, const BandValues<N>& direct) {
  const auto of_lanes = [](auto y, auto beyond) {
    auto p = y * (1.0f / 5040.0f);
    for (const float coefficient : {1.0f / 720.0f, 1.0f / 120.0f, 1.0f / 24.0f, 1.0f / 6.0f, 0.5f})
      p = y * (coefficient - p);
    return y < 0.5f ? 1.0f - p : beyond;
  };
  return BandValues<N>::map(of_lanes, x, direct);
}
template <int N>
[[nodiscard]] BandValues<N> along(const LayerBeam<BandValues<N>>& in,
                                  const LayerBeam<BandValues<N>>& out,
                                  const BandValues<N>& thickness) {
  const BandValues<N> x = min((in.decay + out.decay) * thickness, BandValues<N>::filled(1e30f));
  const BandValues<N> half = BandValues<N>::filled(0.5f);
  const BandValues<N> lost = half + half - in.pass * out.pass;
  return thickness * mean_attenuation(x, lost * reciprocal(max(x, half)));
}
template <int N>
[[nodiscard]] BandValues<N> against(const LayerBeam<BandValues<N>>& in,
                                    const LayerBeam<BandValues<N>>& out,
                                    const BandValues<N>& thickness) {
  const BandValues<N> x = min(abs(in.decay - out.decay) * thickness, BandValues<N>::filled(1e30f));
  const BandValues<N> high = max(in.pass, out.pass), low = min(in.pass, out.pass);
  const BandValues<N> half = BandValues<N>::filled(0.5f);
  return thickness * where_less(x, 0.5f, high * mean_attenuation(x, half),
                                (high - low) * reciprocal(max(x, half)));
}

/// Unpolarized reflectance of a smooth boundary by the cosines on both sides; 0 marks the side on
/// which the light cannot be. Source: [BornWolf1999] §1.5.2, Eq. 21.
template <class V>
[[nodiscard]] V boundary_reflectance(const V& ior_a, const V& mu_a, const V& ior_b, const V& mu_b) {
  const auto square = [](const V& x) { return x * x; };
  const V s_a = ior_a * mu_a, s_b = ior_b * mu_b, p_a = ior_b * mu_a, p_b = ior_a * mu_b;
  const V of_s = square(s_a + s_b), of_p = square(p_a + p_b);
  // (r_s^2 + r_p^2) / 2 over one denominator; both cosines may be 0.
  return (square(s_a - s_b) * of_p + square(p_a - p_b) * of_s) *
         reciprocal(all<V>(2.0) * of_s * of_p + all<V>(1e-36));
}

/// Densities of a layer's scattering over the sphere [1/sr], where it turns light by angles of
/// these 1 - cos.
template <class V, std::size_t Count>
[[nodiscard]] std::array<V, Count> layer_phases(const FirstOrderStack<V>& stack,
                                                const FirstOrderLayer<V>& layer,
                                                const std::array<V, Count>& one_minus_cos) {
  constexpr double inverse_4pi = 0.25 * std::numbers::inv_pi;
  const V one = all<V>(1.0);
  std::array<V, Count> sums{};
  for (std::size_t l = layer.first_lobe; l < layer.first_lobe + layer.lobes; ++l) {
    const PhaseLobe<V>& lobe = stack.lobes[l];
    if (lobe.is_rayleigh) {
      const V weight = all<V>(0.75 * inverse_4pi) * lobe.weight;
      for (std::size_t i = 0; i < Count; ++i) {
        const V cosine = one - one_minus_cos[i];
        sums[i] += weight * (one + cosine * cosine);
      }
      continue;
    }
    const V off = one - lobe.g, weight = all<V>(inverse_4pi) * lobe.weight * off * (one + lobe.g);
    for (std::size_t i = 0; i < Count; ++i) {  // as henyey_greenstein.h
      const V r = reciprocal_root(off * off + (lobe.g + lobe.g) * one_minus_cos[i]);
      sums[i] += weight * (r * r * r);
    }
  }
  return sums;
}
template <class V>
[[nodiscard]] V layer_phase(const FirstOrderStack<V>& stack, const FirstOrderLayer<V>& layer,
                            const V& one_minus_cos) {
  return layer_phases<V, 1>(stack, layer, {one_minus_cos})[0];
}

/// What the event has to do with the two beams: factors of the phase function for light that turns
/// back, and for light that goes on into the same hemisphere.
template <class V>
struct Turns {
  V back, on;
  bool has_on = true;
};

template <class V>
[[nodiscard]] Turns<V> turns(const FirstOrderLayer<V>& layer, const LayerBeam<V>& in,
                             const LayerBeam<V>& out, bool are_above) {
  const V factor = layer.sigma_s * layer.inverse_ior2 * in.inverse_mu * out.inverse_mu;
  const V back = factor * along(in, out, layer.thickness);
  // Two beams from above with nothing below that reflects: both go down, and light can but turn.
  if (are_above && layer.is_matched_on_below)
    return {.back = back * in.down * out.down, .on = all<V>(0.0), .has_on = false};
  return {.back = back * (in.down * out.down + in.up * out.up),
          .on = factor * (in.down * out.up + in.up * out.down) * against(in, out, layer.thickness)};
}

}  // namespace lamina::first_order
