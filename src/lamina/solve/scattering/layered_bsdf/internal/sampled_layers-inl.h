// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// What SampledLayers does; included once per instruction set.

#if defined(LAMINA_SAMPLED_LAYERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_SAMPLED_LAYERS_INL_H
#undef LAMINA_SAMPLED_LAYERS_INL_H
#else
#define LAMINA_SAMPLED_LAYERS_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/layers/optics/henyey_greenstein.h"
#include "lamina/solve/scattering/layered_bsdf/internal/first_order_beam-inl.h"
#include "lamina/solve/scattering/layered_bsdf/sampled_layers.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::sampled_layers::HWY_NAMESPACE {
using namespace first_order::HWY_NAMESPACE;

inline constexpr float pi = std::numbers::pi_v<float>;

template <int N>
float mean(const BandLanes<N>& values) {
  return sum(BandValues<N>(values)) / static_cast<float>(N);
}

/// Chance that scattering turns by an angle of more than acos(c).
inline float chance_beyond(float g, float c) {
  if (std::abs(g) < 1e-3f) return 0.5f * (1.0f + c);
  return (1.0f - g * g) / (2.0f * g) *
         (1.0f / std::sqrt((1.0f - g) * (1.0f - g) + 2.0f * g * (1.0f - c)) - 1.0f / (1.0f + g));
}

/// Mean g of a layer's particles, over bands.
template <int N>
float mean_g(const FirstOrderStack<BandValues<N>>& stack,
             const FirstOrderLayer<BandValues<N>>& layer) {
  float g = 0.0f;
  for (std::size_t l = layer.first_lobe; l < layer.first_lobe + layer.lobes; ++l)
    g += mean(lanes_of(stack.lobes[l].weight) * stack.lobes[l].g);
  return g;
}

/// A row's value at a cosine outside.
template <int N>
BandLanes<N> value_in(const std::array<BandValues<N>, HigherOrders::angles>& row, float mu) {
  const float x = std::sqrt(std::clamp(mu, 0.0f, 1.0f)) * (HigherOrders::angles - 1);
  const int i = std::min(static_cast<int>(x), HigherOrders::angles - 2);
  const auto k = static_cast<std::size_t>(i);
  const BandLanes<N> low = row[k], high = row[k + 1];
  return low + (x - static_cast<float>(i)) * (high - low);
}

/// The part of the higher orders that depends on the eye alone, for light from either side.
template <int N>
void look_at_higher(LayersSeen<N>& seen) {
  using Bands = BandValues<N>;
  using V = BandLanes<N>;
  const HigherOrderBands<N>& orders = *seen.higher;
  const StackBeam<Bands>& out = seen.out;
  const V crossing = (1.0f / pi) * (V::filled(1.0f) - out.surface), ior = out.ior;
  const auto over = [&](const auto& row, const V& mean) {
    return crossing * value_in(row, out.mu[0]) / max(mean, V::filled(1e-30f));
  };
  const bool is_above = out.toward.z >= 0.0;
  store(is_above ? over(orders.above, orders.mean_above) : over(orders.below, orders.mean_below),
        seen.higher_same);
  store(ior * ior * over(is_above ? orders.down : orders.up, orders.mean_through),
        seen.higher_other);
}

template <int N>
void look_at_lobes(LayersSeen<N>& seen) {
  using Bands = BandValues<N>;
  using V = BandLanes<N>;
  const FirstOrderStack<Bands>& stack = *seen.stack;
  const HigherOrderBands<N>* higher = seen.higher;
  const StackBeam<Bands>& out = seen.out;
  // Layers by the light that they scatter first, as seen from the eye.
  const bool is_above = out.toward.z >= 0.0;
  const std::size_t count = stack.layers.size();
  float all = 0.0f, out_of = 0.0f;
  for (std::size_t k = 0; k < count; ++k) {
    const FirstOrderLayer<Bands>& layer = stack.layers[k];
    const LayerBeam<Bands>& beam = out.layers[k];
    const V taken = V(is_above ? beam.down : beam.up) * (V::filled(1.0f) - beam.pass) *
                    layer.sigma_s / max(lanes_of(layer.sigma_t), V::filled(1e-30f));
    const float inverse_ior = 1.0f / layer.ior[0];
    LobeSeen& lobe = seen.lobes[k];
    lobe = {.chance = mean(taken),
            .g = mean_g(stack, layer),
            .mu = beam.mu[0],
            .ratio = out.ior[0] * inverse_ior,
            .inverse_ior = inverse_ior};
    all += lobe.chance;
    // Directions into the upper hemisphere only count where nothing passes below.
    const float rising = lobe.mu;
    const float turned = 0.5f * (chance_beyond(lobe.g, std::sqrt(1.0f - rising * rising)) +
                                 chance_beyond(lobe.g, -std::sqrt(1.0f - rising * rising)));
    out_of += lobe.chance * std::abs(lobe.g) * (stack.is_transmissive() ? 1.0f : turned);
  }
  if (all > 0.0f)
    for (std::size_t k = 0; k < count; ++k) seen.lobes[k].chance /= all;
  float reflected = 1.0f, transmitted = 0.0f, first = 1.0f;
  if (higher && is_above) {
    reflected = mean(value_in(higher->reflected, out.mu[0]));
    transmitted = mean(value_in(higher->transmitted, out.mu[0]));
    const float more = mean(value_in(higher->above, out.mu[0]) + value_in(higher->down, out.mu[0]));
    first = std::clamp(1.0f - more / std::max(reflected + transmitted, 1e-6f), 0.0f, 1.0f);
  } else if (stack.is_transmissive()) {
    transmitted = 1.0f;
  }
  if (!stack.is_transmissive()) transmitted = 0.0f;
  if (all > 0.0f) seen.phase_chance = std::min(0.5f, first * out_of / all);
  const float reflected_share =
      transmitted > 0.0f
          ? std::clamp(reflected / std::max(reflected + transmitted, 1e-6f), 0.05f, 0.95f)
          : 1.0f;
  seen.same_chance = (1.0f - seen.phase_chance) * reflected_share;
  seen.other_chance = (1.0f - seen.phase_chance) * (1.0f - reflected_share);
}

template <int N>
void look(const FirstOrderStack<BandValues<N>>& stack, const HigherOrderBands<N>* higher,
          const Vec3& wo, LayersSeen<N>& seen) {
  seen.stack = &stack;
  seen.higher = higher;
  seen.out = beam_toward(stack, wo);
  seen.lobes = InlineVector<LobeSeen, 4>(stack.layers.size());
  look_at_lobes(seen);
  if (higher) look_at_higher(seen);
}

template <int N>
float pdf(const LayersSeen<N>& seen, const StackBeam<BandValues<N>>& in) {
  const float mu = static_cast<float>(std::abs(in.toward.z));
  const Vec3& wo = seen.out.toward;
  const bool is_same = (in.toward.z >= 0.0) == (wo.z >= 0.0);
  float pdf = (is_same ? seen.same_chance : seen.other_chance) * mu * (1.0f / pi);
  if (!(seen.phase_chance > 0.0f)) return pdf;
  const auto x = static_cast<float>(in.toward.x), y = static_cast<float>(in.toward.y);
  const auto wo_x = static_cast<float>(wo.x), wo_y = static_cast<float>(wo.y);
  const float sin2 = 1.0f - mu * mu;
  for (std::size_t k = 0; k < seen.lobes.size(); ++k) {
    const LobeSeen& lobe = seen.lobes[k];
    const float from = in.ior[0] * lobe.inverse_ior, mu_in = in.layers[k].mu[0];
    if (from * from * sin2 >= 1.0f) continue;  // such light does not get into the layer
    // Light that comes from wi goes against it: the sum of both directions is how far it turns.
    const float dx = lobe.ratio * wo_x + from * x, dy = lobe.ratio * wo_y + from * y;
    const float dz = is_same ? lobe.mu + mu_in : lobe.mu - mu_in;
    const float one_minus_cos = 0.5f * (dx * dx + dy * dy + dz * dz);
    // Per solid angle outside: refraction conserves n^2 mu dw.
    pdf += seen.phase_chance * lobe.chance * henyey_greenstein(lobe.g, one_minus_cos) * mu * from *
           from * in.layers[k].inverse_mu[0];
  }
  return pdf;
}

template <int N>
void evaluate(const LayersSeen<N>& seen, const Vec3& wi, LayersValue<N>& value) {
  using V = BandLanes<N>;
  const StackBeam<BandValues<N>> in = beam_toward(*seen.stack, wi);
  const V first = bsdf(*seen.stack, in, seen.out);
  store(first, value.bsdf);
  value.pdf = pdf(seen, in);
  value.surface = in.surface;
  if (!seen.higher) return;
  const HigherOrderBands<N>& orders = *seen.higher;
  const bool from_above = wi.z >= 0.0, to_above = seen.out.toward.z >= 0.0;
  const V eye = from_above == to_above ? seen.higher_same : seen.higher_other;
  const auto& row =
      from_above ? (to_above ? orders.above : orders.down) : (to_above ? orders.up : orders.below);
  store(first + (V::filled(1.0f) - in.surface) * eye * value_in(row, in.mu[0]), value.bsdf);
}

template <int N>
Vec3 draw_by_phase(const LayersSeen<N>& seen, float u, float u1, float u2) {
  std::size_t k = 0;
  while (k + 1 < seen.lobes.size() && u >= seen.lobes[k].chance) u -= seen.lobes[k++].chance;
  const LobeSeen& lobe = seen.lobes[k];
  const Vec3& out = seen.out.toward;
  const double side = out.z >= 0.0 ? 1.0 : -1.0;
  const auto ratio = static_cast<double>(lobe.ratio);
  const Vec3 wo{ratio * out.x, ratio * out.y, side * static_cast<double>(lobe.mu)};
  const float one_minus_cos = sample_henyey_greenstein(lobe.g, u1);
  // Light that goes on by this angle comes from there: wi points against it.
  const float sine = std::sqrt(std::max(0.0f, one_minus_cos * (2.0f - one_minus_cos)));
  const float phi = 2.0f * pi * u2;
  const Frame frame = make_frame(normalize(wo));
  const Vec3 wi = -frame.to_world({static_cast<double>(sine * std::cos(phi)),
                                   static_cast<double>(sine * std::sin(phi)),
                                   1.0 - static_cast<double>(one_minus_cos)});
  const bool is_above = wi.z > 0.0;
  if (!is_above && !seen.stack->is_transmissive()) return {};
  const float ior = is_above ? seen.stack->ior_above[0] : seen.stack->ior_below[0];
  const auto scale = static_cast<double>(seen.stack->layers[k].ior[0] / ior);
  const double x = scale * wi.x, y = scale * wi.y, sine2 = x * x + y * y;
  if (sine2 >= 1.0) return {};  // totally reflected
  const double z = std::sqrt(1.0 - sine2);
  return {x, y, is_above ? z : -z};
}

template <int N>
void sample(const LayersSeen<N>& seen, float u, float u1, float u2, LayersSample<N>& drawn) {
  Vec3& wi = drawn.wi;
  if (u < seen.phase_chance) {
    wi = draw_by_phase(seen, u / seen.phase_chance, u1, u2);
  } else {
    const float r = std::sqrt(u1), phi = 2.0f * pi * u2;
    const bool is_other = u - seen.phase_chance >= seen.same_chance;
    const double z = std::sqrt(std::max(0.0, 1.0 - static_cast<double>(u1)));
    wi = {static_cast<double>(r * std::cos(phi)), static_cast<double>(r * std::sin(phi)),
          is_other == (seen.out.toward.z >= 0.0) ? -z : z};
  }
  if (std::abs(wi.z) < 1e-6)
    drawn = {};
  else
    evaluate(seen, wi, drawn.value);
}

}  // namespace lamina::sampled_layers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
