// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0

// Beams and the first order of S = double or BandValues<N>; included once per instruction set.

#if defined(LAMINA_FIRST_ORDER_BEAM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMINA_FIRST_ORDER_BEAM_INL_H
#undef LAMINA_FIRST_ORDER_BEAM_INL_H
#else
#define LAMINA_FIRST_ORDER_BEAM_INL_H
#endif

#include <cassert>

#include "lamina/solve/scattering/layered_bsdf/internal/first_order-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lamina::first_order::HWY_NAMESPACE {

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
template <class S, class V = LanesOf<S>>
void refract(const FirstOrderStack<S>& stack, StackBeam<S>& beam,
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
    const V inside = max(mu, least);
    store(inside, beam.layers[k].mu);
    store(one / inside, beam.layers[k].inverse_mu);
  }
}

/// Refracts once where all bands share their directions: the lanes are media then, from the top,
/// not bands.
template <int N>
void refract_once(const FirstOrderStack<BandValues<N>>& stack, StackBeam<BandValues<N>>& beam,
                  InlineVector<Crossing<BandLanes<N>>, 5>& crossings) {
  using V = BandLanes<N>;
  using Media = LanesOf<StackMedia::Each>;
  const StackMedia& media = stack.media;
  const std::size_t count = stack.layers.size();
  const bool is_above = beam.toward.z >= 0.0;
  const float mu2 = beam.mu[0] * beam.mu[0];
  // 1 - (1 - mu^2) ratio^2, which keeps the digits of a grazing cosine.
  const auto cosine = [&](const Media& ratio2) {
    return sqrt(max(Media::filled(1.0f) - ratio2 + mu2 * ratio2, Media::filled(0.0f)));
  };
  const int side = is_above ? 0 : 1;
  const Media mu = cosine(media.ratio2[side]);
  const Media lanes = max(mu, Media::filled(1e-7f));
  const StackMedia::Each inside(lanes), inverse(reciprocal(lanes));
  const StackMedia::Each mirror(
      boundary_reflectance<Media>(media.ior, mu, media.next_ior, cosine(media.next_ratio2[side])));
  for (std::size_t i = 0; i <= count; ++i) {
    const std::size_t boundary = is_above ? i : count - i;
    crossings[i].has_mirror = !stack.is_matched_at(boundary);
    crossings[i].mirror = V::filled(mirror[static_cast<int>(boundary)]);
    if (i == count) break;
    const std::size_t k = is_above ? i : count - 1 - i;
    store(V::filled(inside[static_cast<int>(k) + 1]), beam.layers[k].mu);
    store(V::filled(inverse[static_cast<int>(k) + 1]), beam.layers[k].inverse_mu);
  }
}

template <int N>
void refract_all(const FirstOrderStack<BandValues<N>>& stack, StackBeam<BandValues<N>>& beam,
                 InlineVector<Crossing<BandLanes<N>>, 5>& crossings) {
  if (stack.has_one_ior && stack.layers.size() + 2 <= std::size_t{StackMedia::most})
    refract_once(stack, beam, crossings);
  else
    refract(stack, beam, crossings);
}
inline void refract_all(const FirstOrderStack<double>& stack, StackBeam<double>& beam,
                        InlineVector<Crossing<double>, 5>& crossings) {
  refract(stack, beam, crossings);
}

template <class S, class V = LanesOf<S>>
V ground_bsdf(const FirstOrderStack<S>& stack, const StackBeam<S>& in, const StackBeam<S>& out) {
  const V ior = stack.ior_below;
  return all<V>(std::numbers::inv_pi) * stack.ground_reflectance * in.ground * out.ground /
         (ior * ior);
}

template <class S>
StackBeam<S> beam_toward(const FirstOrderStack<S>& stack, const Vec3& toward) {
  using V = LanesOf<S>;
  const std::size_t count = stack.layers.size();
  const bool is_above = toward.z >= 0.0;
  assert(is_above || stack.is_transmissive());
  const bool has_interreflections = stack.reflections == InternalReflections::summed;
  const V one = all<V>(1.0), zero = all<V>(0.0);
  StackBeam<S> beam;
  beam.layers.reset(count);
  beam.toward = toward;
  beam.mu = all<S>(std::max(std::abs(toward.z), 1e-7));
  beam.ior = is_above ? stack.ior_above : stack.ior_below;
  InlineVector<Crossing<V>, 5> crossings(count + 1);
  refract_all(stack, beam, crossings);

  // Layers in the order in which the light meets them. From the far side on: what each boundary, of
  // reflectance m, and all behind it send back, m + (1 - m)^2 b / (1 - m b) for b = n / d from
  // behind.
  const auto at = [&](std::size_t i) { return is_above ? i : count - 1 - i; };
  LayerBeam<S>* const layers = beam.layers.data();
  const FirstOrderLayer<S>* const media = stack.layers.data();
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
    LayerBeam<S>& layer = layers[at(i - 1)];
    const FirstOrderLayer<S>& medium = media[at(i - 1)];
    const V decay = V(medium.sigma_t) * layer.inverse_mu;
    const V pass = exp_minus(decay * medium.thickness);
    store(decay, layer.decay);
    store(pass, layer.pass);
    has_behind = has_interreflections && crossing.has_back;
    n = has_behind ? crossing.back * pass * pass : zero;
    d = has_behind ? crossing.loss : one;
  }
  // Going down, the flux behind a boundary is the product of all (1 - m) and passes above it, times
  // its behind_loss over the first loss: those between cancel.
  const V scale = reciprocal(crossed[0].loss);
  store(crossed[0].mirror, beam.surface);
  store(crossed[0].back * scale, beam.reflected);
  V way = scale;
  for (std::size_t i = 0; i < count; ++i) {
    LayerBeam<S>& layer = layers[at(i)];
    if (crossed[i].has_mirror) way *= one - crossed[i].mirror;
    const V entering = way * crossed[i].behind_loss;
    way *= layer.pass;
    const Crossing<V>& next = crossed[i + 1];
    const V returning = has_interreflections && next.has_back ? way * next.back : zero;
    store(is_above ? entering : returning, layer.down);
    store(is_above ? returning : entering, layer.up);
  }
  store(way * (one - crossed[count].mirror) * crossed[count].behind_loss, beam.ground);
  return beam;
}

template <class S>
LanesOf<S> bsdf(const FirstOrderStack<S>& stack, const StackBeam<S>& in, const StackBeam<S>& out) {
  using V = LanesOf<S>;
  const bool are_above = in.toward.z >= 0.0 && out.toward.z >= 0.0;
  const V one = all<V>(1.0), ior_in = in.ior, ior_out = out.ior;
  // Horizontal parts of both directions, for an index of 1: multiplied, and how far light that goes
  // on is turned aside, squared.
  const V sines =
      ior_in * ior_out * all<V>(-in.toward.x * out.toward.x - in.toward.y * out.toward.y);
  const V aside_x = ior_in * all<V>(in.toward.x) + ior_out * all<V>(out.toward.x);
  const V aside_y = ior_in * all<V>(in.toward.y) + ior_out * all<V>(out.toward.y);
  const V aside2 = aside_x * aside_x + aside_y * aside_y;
  const FirstOrderLayer<S>* const layers = stack.layers.data();
  const LayerBeam<S>*const of_in = in.layers.data(), *const of_out = out.layers.data();
  V sum = all<V>(0.0);
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    const FirstOrderLayer<S>& layer = layers[k];
    const LayerBeam<V> from = lanes_of(of_in[k]), to = lanes_of(of_out[k]);
    const Turns<V> turn = turns(layer, from, to, are_above);
    const V inverse_ior2 = layer.inverse_ior2;
    const V across = sines * inverse_ior2;
    const V cosines = from.mu * to.mu;
    const V back = min(one - across + cosines, all<V>(2.0));
    if (turn.has_on) {
      // From the difference of both directions, as they may be almost the same.
      const V apart = from.mu - to.mu;
      const V on = all<V>(0.5) * (aside2 * inverse_ior2 + apart * apart);
      const auto [p_back, p_on] = phases<S, V, 2>(stack, layer, {back, on});
      sum += turn.back * p_back + turn.on * p_on;
    } else {
      sum += turn.back * phases<S, V, 1>(stack, layer, {back})[0];
    }
  }
  if (stack.has_ground) sum += ground_bsdf(stack, in, out);
  return ior_out * ior_out * sum;
}

}  // namespace lamina::first_order::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
