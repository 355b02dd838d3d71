// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/sampled_layers.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

template <int N>
float mean(const BandValues<N>& values) {
  return sum(values) / static_cast<float>(N);
}

float henyey_greenstein(float g, float cos_theta) {
  const float k = (1.0f - g) * (1.0f - g) + 2.0f * g * (1.0f - cos_theta);
  return 0.25f / pi * (1.0f - g * g) / (k * std::sqrt(k));
}

/// Chance that scattering turns by an angle of more than acos(c).
float chance_beyond(float g, float c) {
  if (std::abs(g) < 1e-3f) return 0.5f * (1.0f + c);
  return (1.0f - g * g) / (2.0f * g) *
         (1.0f / std::sqrt(1.0f + g * g - 2.0f * g * c) - 1.0f / (1.0f + g));
}

/// Mean g of a layer's particles, over bands.
template <int N>
float mean_g(const FirstOrderStack<BandValues<N>>& stack,
             const FirstOrderLayer<BandValues<N>>& layer) {
  float g = 0.0f;
  for (std::size_t l = layer.first_lobe; l < layer.first_lobe + layer.lobes; ++l)
    g += mean(stack.lobes[l].weight * stack.lobes[l].g);
  return g;
}

}  // namespace

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
  const float x = std::sqrt(std::clamp(mu, 0.0f, 1.0f)) * (HigherOrders::angles - 1);
  const int i = std::min(static_cast<int>(x), HigherOrders::angles - 2);
  const auto k = static_cast<std::size_t>(i);
  return row[k] + (x - static_cast<float>(i)) * (row[k + 1] - row[k]);
}

template <int N>
BandValues<N> higher_orders_inside(const HigherOrderBands<N>& orders,
                                   const StackBeam<BandValues<N>>& in,
                                   const StackBeam<BandValues<N>>& out) {
  using Bands = BandValues<N>;
  const auto over = [&](const Bands& value, const Bands& mean) {
    return (1.0f / pi) * value / max(mean, Bands::filled(1e-30f));
  };
  const bool from_above = in.toward.z >= 0.0, to_above = out.toward.z >= 0.0;
  const float mu_in = in.mu[0], mu_out = out.mu[0];
  if (from_above && to_above)
    return over(value_at(orders.above, mu_in) * value_at(orders.above, mu_out), orders.mean_above);
  if (!from_above && !to_above)
    return over(value_at(orders.below, mu_in) * value_at(orders.below, mu_out), orders.mean_below);
  const Bands down = value_at(orders.down, from_above ? mu_in : mu_out);
  const Bands up = value_at(orders.up, from_above ? mu_out : mu_in);
  return out.ior * out.ior * over(down * up, orders.mean_through);
}

template <int N>
SampledLayers<N>::SampledLayers(const FirstOrderStack<Bands>& stack,
                                const HigherOrderBands<N>* higher, const Vec3& wo)
    : stack_(stack),
      higher_(higher),
      out_(make_beam(stack, wo)),
      mirrored_inside_(max(out_.reflected - out_.surface, Bands{})),
      lobes_(stack.layers.size()) {
  // Layers by the light that they scatter first, as seen from wo.
  const bool is_above = wo.z >= 0.0;
  const std::size_t count = stack.layers.size();
  float all = 0.0f, out_of = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = is_above ? i : count - 1 - i;
    const FirstOrderLayer<Bands>& layer = stack.layers[k];
    const LayerBeam<Bands>& beam = out_.layers[k];
    const Bands taken = (is_above ? beam.down : beam.up) * (Bands::filled(1.0f) - beam.pass) *
                        layer.sigma_s / max(layer.sigma_t, Bands::filled(1e-30f));
    Lobe& lobe = lobes_[k];
    lobe = {.chance = mean(taken),
            .g = mean_g(stack, layer),
            .mu = beam.mu[0],
            .ratio = out_.ior[0] / layer.ior[0]};
    all += lobe.chance;
    // Directions into the upper hemisphere only count where nothing passes below.
    const float rising = lobe.mu;
    const float turned = 0.5f * (chance_beyond(lobe.g, std::sqrt(1.0f - rising * rising)) +
                                 chance_beyond(lobe.g, -std::sqrt(1.0f - rising * rising)));
    out_of += lobe.chance * std::abs(lobe.g) * (stack.is_transmissive() ? 1.0f : turned);
  }
  if (all > 0.0f)
    for (std::size_t k = 0; k < count; ++k) lobes_[k].chance /= all;
  float reflected = 1.0f, transmitted = 0.0f, first = 1.0f;
  if (higher && is_above) {
    reflected = mean(value_at(higher->reflected, out_.mu[0]));
    transmitted = mean(value_at(higher->transmitted, out_.mu[0]));
    const float more =
        mean(value_at(higher->above, out_.mu[0]) + value_at(higher->down, out_.mu[0]));
    first = std::clamp(1.0f - more / std::max(reflected + transmitted, 1e-6f), 0.0f, 1.0f);
  } else if (stack.is_transmissive()) {
    transmitted = 1.0f;
  }
  if (!stack.is_transmissive()) transmitted = 0.0f;
  if (all > 0.0f) phase_chance_ = std::min(0.5f, first * out_of / all);
  const float reflected_share =
      transmitted > 0.0f
          ? std::clamp(reflected / std::max(reflected + transmitted, 1e-6f), 0.05f, 0.95f)
          : 1.0f;
  same_chance_ = (1.0f - phase_chance_) * reflected_share;
  other_chance_ = (1.0f - phase_chance_) * (1.0f - reflected_share);
}

template <int N>
float SampledLayers<N>::pdf(const StackBeam<Bands>& in) const {
  const float mu = static_cast<float>(std::abs(in.toward.z));
  const bool is_same = (in.toward.z >= 0.0) == (out_.toward.z >= 0.0);
  float pdf = (is_same ? same_chance_ : other_chance_) * mu / pi;
  if (!(phase_chance_ > 0.0f)) return pdf;
  const auto across = static_cast<float>(in.toward.x * out_.toward.x + in.toward.y * out_.toward.y);
  const float sin2 = 1.0f - mu * mu;
  for (std::size_t k = 0; k < lobes_.size(); ++k) {
    const Lobe& lobe = lobes_[k];
    const float from = in.ior[0] / stack_.layers[k].ior[0], mu_in = in.layers[k].mu[0];
    if (from * from * sin2 >= 1.0f) continue;  // such light does not get into the layer
    const float along = lobe.mu * mu_in;
    const float turned =
        std::clamp(-from * lobe.ratio * across + (is_same ? -along : along), -1.0f, 1.0f);
    // Per solid angle outside: refraction conserves n^2 mu dw.
    pdf +=
        phase_chance_ * lobe.chance * henyey_greenstein(lobe.g, turned) * mu * from * from / mu_in;
  }
  return pdf;
}

template <int N>
typename SampledLayers<N>::Value SampledLayers<N>::evaluate(const StackBeam<Bands>& in) const {
  Value value{.bsdf = first_order_bsdf(stack_, in, out_), .pdf = pdf(in), .surface = in.surface};
  if (higher_) {
    const Bands one = Bands::filled(1.0f);
    value.bsdf +=
        (one - in.surface) * (one - out_.surface) * higher_orders_inside(*higher_, in, out_);
  }
  return value;
}

template <int N>
typename SampledLayers<N>::Value SampledLayers<N>::evaluate(const Vec3& wi) const {
  return evaluate(make_beam(stack_, wi));
}

template <int N>
Vec3 SampledLayers<N>::draw_by_phase(float u, float u1, float u2) const {
  std::size_t k = 0;
  while (k + 1 < lobes_.size() && u >= lobes_[k].chance) u -= lobes_[k++].chance;
  const Lobe& lobe = lobes_[k];
  const double side = out_.toward.z >= 0.0 ? 1.0 : -1.0;
  const auto ratio = static_cast<double>(lobe.ratio);
  const Vec3 wo{ratio * out_.toward.x, ratio * out_.toward.y, side * static_cast<double>(lobe.mu)};
  float c = 1.0f - 2.0f * u1;
  if (std::abs(lobe.g) > 1e-3f) {
    const float s = (1.0f - lobe.g * lobe.g) / (1.0f - lobe.g + 2.0f * lobe.g * u1);
    c = std::clamp((1.0f + lobe.g * lobe.g - s * s) / (2.0f * lobe.g), -1.0f, 1.0f);
  }
  // Light that goes on by the angle of cosine c comes from there: wi points against it.
  const float sine = std::sqrt(std::max(0.0f, 1.0f - c * c)), phi = 2.0f * pi * u2;
  const Frame frame = make_frame(normalize(wo));
  const Vec3 wi =
      -frame.to_world({static_cast<double>(sine * std::cos(phi)),
                       static_cast<double>(sine * std::sin(phi)), static_cast<double>(c)});
  const bool is_above = wi.z > 0.0;
  if (!is_above && !stack_.is_transmissive()) return {};
  const float ior = is_above ? stack_.ior_above[0] : stack_.ior_below[0];
  const auto scale = static_cast<double>(stack_.layers[k].ior[0] / ior);
  const double x = scale * wi.x, y = scale * wi.y, sine2 = x * x + y * y;
  if (sine2 >= 1.0) return {};  // totally reflected
  const double z = std::sqrt(1.0 - sine2);
  return {x, y, is_above ? z : -z};
}

template <int N>
typename SampledLayers<N>::Sample SampledLayers<N>::sample(float u, float u1, float u2) const {
  Vec3 wi;
  if (u < phase_chance_) {
    wi = draw_by_phase(u / phase_chance_, u1, u2);
  } else {
    const float r = std::sqrt(u1), phi = 2.0f * pi * u2;
    const bool is_other = u - phase_chance_ >= same_chance_;
    const double z = std::sqrt(std::max(0.0, 1.0 - static_cast<double>(u1)));
    wi = {static_cast<double>(r * std::cos(phi)), static_cast<double>(r * std::sin(phi)),
          is_other == (out_.toward.z >= 0.0) ? -z : z};
  }
  if (std::abs(wi.z) < 1e-6) return {};
  return {.wi = wi, .value = evaluate(wi)};
}

#define LAMINA_SAMPLED_LAYERS(N)                                                                  \
  template HigherOrderBands<N> make_higher_order_bands<N>(std::span<const HigherOrders>);         \
  template BandValues<N> value_at(const std::array<BandValues<N>, HigherOrders::angles>&, float); \
  template BandValues<N> higher_orders_inside(const HigherOrderBands<N>&,                         \
                                              const StackBeam<BandValues<N>>&,                    \
                                              const StackBeam<BandValues<N>>&);                   \
  template class SampledLayers<N>;
LAMINA_SAMPLED_LAYERS(4)
LAMINA_SAMPLED_LAYERS(8)
LAMINA_SAMPLED_LAYERS(16)
#undef LAMINA_SAMPLED_LAYERS

}  // namespace lamina
