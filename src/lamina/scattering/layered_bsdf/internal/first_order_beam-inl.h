// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Beams and the first order, written once for all V; who includes this makes its own code of it.

#include <cassert>

#include "lamina/scattering/layered_bsdf/internal/first_order-inl.h"

namespace lamina {
namespace first_order {

/// A boundary on a beam's way, and all that lies behind it. What both send back is the fraction
/// back / loss, all returns summed; kept as two numbers, so that a whole stack takes one division.
template <class V>
struct Crossing {
  V mirror;  ///< reflectance of the boundary alone
  V back, loss;
  V behind_loss;  ///< `loss` of the next boundary
  bool has_mirror, has_back;
};

/// Cosines in all layers and reflectances of all boundaries, band by band.
template <class V>
void refract(const FirstOrderStack<V>& stack, StackBeam<V>& beam,
             InlineVector<Crossing<V>, 5>& crossings) {
  const std::size_t count = stack.layers.size();
  const bool is_above = beam.toward.z >= 0.0;
  const double sine2 = beam.toward.x * beam.toward.x + beam.toward.y * beam.toward.y;
  const V one = all<V>(1.0), least = all<V>(1e-7);
  V ior = beam.ior, mu = beam.mu;
  const V invariant = all<V>(sine2) * ior * ior;
  for (std::size_t i = 0; i <= count; ++i) {
    const std::size_t boundary = is_above ? i : count - i;  // [layer below it]
    const std::size_t k = is_above ? i : count - 1 - i;
    Crossing<V>& crossing = crossings[i];
    crossing.has_mirror = !stack.is_matched_at(boundary);
    crossing.mirror = all<V>(0.0);
    if (crossing.has_mirror) {
      const V next = i < count ? stack.layers[k].ior : is_above ? stack.ior_below : stack.ior_above;
      const V mu_next = sqrt(max(one - invariant / (next * next), all<V>(0.0)));
      crossing.mirror = boundary_reflectance(ior, mu, next, mu_next);
      mu = mu_next;
      ior = next;
    }
    if (i == count) break;
    beam.layers[k].mu = max(mu, least);
    beam.layers[k].inverse_mu = one / beam.layers[k].mu;
  }
}

/// The same where all bands share their directions: the lanes are media then, from the top, not
/// bands.
template <int N>
void refract_once(const FirstOrderStack<BandValues<N>>& stack, StackBeam<BandValues<N>>& beam,
                  InlineVector<Crossing<BandValues<N>>, 5>& crossings) {
  using Bands = BandValues<N>;
  using Media = StackMedia::Each;
  const StackMedia& media = stack.media;
  const std::size_t count = stack.layers.size();
  const bool is_above = beam.toward.z >= 0.0;
  const float mu2 = beam.mu[0] * beam.mu[0];
  // 1 - (1 - mu^2) ratio^2, which keeps the digits of a grazing cosine.
  const auto cosine = [&](const Media& ratio2) {
    return sqrt(max(Media::filled(1.0f) - ratio2 + mu2 * ratio2, Media{}));
  };
  const int side = is_above ? 0 : 1;
  const Media mu = cosine(media.ratio2[side]);
  const Media mirror =
      boundary_reflectance(media.ior, mu, media.next_ior, cosine(media.next_ratio2[side]));
  const Media inside = max(mu, Media::filled(1e-7f)), inverse = reciprocal(inside);
  for (std::size_t i = 0; i <= count; ++i) {
    const std::size_t boundary = is_above ? i : count - i;
    crossings[i].has_mirror = !stack.is_matched_at(boundary);
    crossings[i].mirror = Bands::filled(mirror[static_cast<int>(boundary)]);
    if (i == count) break;
    const std::size_t k = is_above ? i : count - 1 - i;
    beam.layers[k].mu = Bands::filled(inside[static_cast<int>(k) + 1]);
    beam.layers[k].inverse_mu = Bands::filled(inverse[static_cast<int>(k) + 1]);
  }
}

template <int N>
void refract_all(const FirstOrderStack<BandValues<N>>& stack, StackBeam<BandValues<N>>& beam,
                 InlineVector<Crossing<BandValues<N>>, 5>& crossings) {
  if (stack.has_one_ior && stack.layers.size() + 2 <= std::size_t{StackMedia::most})
    refract_once(stack, beam, crossings);
  else
    refract(stack, beam, crossings);
}
inline void refract_all(const FirstOrderStack<double>& stack, StackBeam<double>& beam,
                        InlineVector<Crossing<double>, 5>& crossings) {
  refract(stack, beam, crossings);
}

template <class V>
V ground_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in, const StackBeam<V>& out) {
  return all<V>(std::numbers::inv_pi) * stack.ground_reflectance * in.ground * out.ground /
         (stack.ior_below * stack.ior_below);
}

}  // namespace first_order

template <class V>
StackBeam<V> make_beam(const FirstOrderStack<V>& stack, const Vec3& toward) {
  using namespace first_order;
  const std::size_t count = stack.layers.size();
  const bool is_above = toward.z >= 0.0;
  assert(is_above || stack.is_transmissive());
  const bool has_interreflections = stack.reflections == InternalReflections::summed;
  const V one = all<V>(1.0), zero = all<V>(0.0);
  StackBeam<V> beam;
  beam.layers.reset(count);
  beam.toward = toward;
  beam.mu = all<V>(std::max(std::abs(toward.z), 1e-7));
  beam.ior = is_above ? stack.ior_above : stack.ior_below;
  InlineVector<Crossing<V>, 5> crossings(count + 1);
  refract_all(stack, beam, crossings);

  // Layers in the order in which the light meets them. From the far side on: what each boundary, of
  // reflectance m, and all behind it send back, m + (1 - m)^2 b / (1 - m b) for b = n / d from
  // behind.
  const auto at = [&](std::size_t i) { return is_above ? i : count - 1 - i; };
  LayerBeam<V>* const layers = beam.layers.data();
  const FirstOrderLayer<V>* const media = stack.layers.data();
  Crossing<V>* const crossed = crossings.data();
  V n = zero, d = one;  // nothing comes back unscattered from a ground, or from outside
  bool has_behind = false;
  for (std::size_t i = count + 1; i-- > 0;) {
    Crossing<V>& crossing = crossed[i];
    const V& mirror = crossing.mirror;
    crossing.back = mirror * d;
    crossing.loss = crossing.behind_loss = d;
    if (has_behind) {
      // Light between two perfect mirrors comes back to neither side; the bound keeps it finite.
      crossing.loss = max(d - mirror * n, d * all<V>(1e-14));
      crossing.back = mirror * crossing.loss + (one - mirror) * (one - mirror) * n;
    }
    crossing.has_back = crossing.has_mirror || has_behind;
    if (i == 0) break;
    LayerBeam<V>& layer = layers[at(i - 1)];
    const FirstOrderLayer<V>& medium = media[at(i - 1)];
    layer.decay = medium.sigma_t * layer.inverse_mu;
    layer.pass = exp_minus(layer.decay * medium.thickness);
    has_behind = has_interreflections && crossing.has_back;
    n = has_behind ? crossing.back * layer.pass * layer.pass : zero;
    d = has_behind ? crossing.loss : one;
  }
  // Going down, the flux behind a boundary is the product of all (1 - m) and passes above it, times
  // its behind_loss over the first loss: those between cancel.
  const V scale = reciprocal(crossed[0].loss);
  beam.surface = crossed[0].mirror;
  beam.reflected = crossed[0].back * scale;
  V way = scale;
  for (std::size_t i = 0; i < count; ++i) {
    LayerBeam<V>& layer = layers[at(i)];
    if (crossed[i].has_mirror) way *= one - crossed[i].mirror;
    const V entering = way * crossed[i].behind_loss;
    way *= layer.pass;
    const Crossing<V>& next = crossed[i + 1];
    const V returning = has_interreflections && next.has_back ? way * next.back : zero;
    layer.down = is_above ? entering : returning;
    layer.up = is_above ? returning : entering;
  }
  beam.ground = way * (one - crossed[count].mirror) * crossed[count].behind_loss;
  return beam;
}

template <class V>
V first_order_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in,
                   const StackBeam<V>& out) {
  using namespace first_order;
  const bool are_above = in.toward.z >= 0.0 && out.toward.z >= 0.0;
  const V one = all<V>(1.0);
  // Horizontal parts of both directions, for an index of 1: multiplied, and how far light that goes
  // on is turned aside, squared.
  const V sines =
      in.ior * out.ior * all<V>(-in.toward.x * out.toward.x - in.toward.y * out.toward.y);
  const V aside_x = in.ior * all<V>(in.toward.x) + out.ior * all<V>(out.toward.x);
  const V aside_y = in.ior * all<V>(in.toward.y) + out.ior * all<V>(out.toward.y);
  const V aside2 = aside_x * aside_x + aside_y * aside_y;
  const FirstOrderLayer<V>* const layers = stack.layers.data();
  const LayerBeam<V>*const of_in = in.layers.data(), *const of_out = out.layers.data();
  V sum = all<V>(0.0);
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    const FirstOrderLayer<V>& layer = layers[k];
    const Turns<V> turn = turns(layer, of_in[k], of_out[k], are_above);
    const V across = sines * layer.inverse_ior2;
    const V cosines = of_in[k].mu * of_out[k].mu;
    const V back = min(one - across + cosines, all<V>(2.0));
    if (turn.has_on) {
      // From the difference of both directions, as they may be almost the same.
      const V along = of_in[k].mu - of_out[k].mu;
      const V on = all<V>(0.5) * (aside2 * layer.inverse_ior2 + along * along);
      const auto [p_back, p_on] = layer_phases<V, 2>(stack, layer, {back, on});
      sum += turn.back * p_back + turn.on * p_on;
    } else {
      sum += turn.back * layer_phase(stack, layer, back);
    }
  }
  if (stack.has_ground) sum += ground_bsdf(stack, in, out);
  return out.ior * out.ior * sum;
}

}  // namespace lamina
