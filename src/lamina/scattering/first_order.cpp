// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/first_order.h"

#include <cassert>
#include <string>
#include <variant>

#include "lamina/core/error.h"
#include "lamina/core/quadrature.h"
#include "lamina/scattering/first_order-inl.h"

namespace lamina {
namespace {

using namespace first_order;

constexpr double half_space = 1e12;  // [mm], thicker than anything seen through

void set_lane(double& value, std::size_t, double x) { value = x; }
template <int N>
void set_lane(BandValues<N>& value, std::size_t lane, double x) {
  value.v[lane] = static_cast<float>(x);
}

std::vector<PhaseMixture::Lobe> lobes_of(const Layer& layer) {
  const PhaseFunction phase = phase_function(layer);
  if (const auto* mixture = std::get_if<PhaseMixture>(&phase)) return mixture->lobes;
  if (std::holds_alternative<Rayleigh>(phase)) return {{1.0, Rayleigh{}}};
  return {{1.0, std::get<HenyeyGreenstein>(phase)}};
}

bool is_rayleigh(const PhaseMixture::Lobe& lobe) {
  return std::holds_alternative<Rayleigh>(lobe.phase);
}

void require_smooth_inside(const LayerStack& stack) {
  const auto require = [](const Interface& boundary, const std::string& where) {
    if (boundary.roughness > 0.0)
      throw InvalidInput(where +
                         ": first order needs smooth boundaries below the top, but the "
                         "roughness is " +
                         std::to_string(boundary.roughness));
  };
  for (std::size_t k = 1; k < stack.layers().size(); ++k)
    require(stack.layers()[k].top, "layer " + std::to_string(k));
  require(stack.ground().top, "ground");
}

/// All bands must have the same layers with the same kinds of particles.
void require_one_build(const LayerStack& a, const LayerStack& b) {
  bool is_same =
      a.layers().size() == b.layers().size() && is_semi_infinite(a) == is_semi_infinite(b);
  for (std::size_t k = 0; is_same && k < a.layers().size(); ++k) {
    const auto of_a = lobes_of(a.layers()[k]), of_b = lobes_of(b.layers()[k]);
    is_same = of_a.size() == of_b.size();
    for (std::size_t l = 0; is_same && l < of_a.size(); ++l)
      is_same = is_rayleigh(of_a[l]) == is_rayleigh(of_b[l]);
  }
  if (!is_same) throw InvalidInput("bands: all must have the same layers and kinds of particles");
}

bool has_equal_indices(const LayerStack& a, const LayerStack& b) {
  for (std::size_t k = 0; k < a.layers().size(); ++k)
    if (a.layers()[k].medium.ior != b.layers()[k].medium.ior) return false;
  return a.ior_above() == b.ior_above() && a.ior_below() == b.ior_below();
}

template <class V>
FirstOrderStack<V> make_stack(std::span<const LayerStack> bands, std::size_t lanes,
                              InternalReflections reflections) {
  assert(!bands.empty() && bands.size() <= lanes);
  const std::span<const Layer> first = bands.front().layers();
  const std::size_t count = first.size();
  std::size_t lobes = 0;
  for (const Layer& layer : first) lobes += lobes_of(layer).size();
  FirstOrderStack<V> made{.layers = InlineVector<FirstOrderLayer<V>, 4>(count),
                          .lobes = InlineVector<PhaseLobe<V>, 6>(lobes)};
  for (std::size_t l = 0; l < lobes; ++l) made.lobes[l] = {};
  for (std::size_t k = 0, lobe = 0; k < count; lobe += made.layers[k++].lobes)
    made.layers[k] = {
        .first_lobe = lobe, .lobes = lobes_of(first[k]).size(), .is_matched_above = true};
  made.is_semi_infinite = is_semi_infinite(bands.front());
  made.is_matched_below = true;
  made.reflections = reflections;

  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const LayerStack& stack = bands[std::min(lane, bands.size() - 1)];
    require_smooth_inside(stack);
    require_one_build(bands.front(), stack);
    set_lane(made.ior_above, lane, stack.ior_above());
    set_lane(made.ior_below, lane, stack.ior_below());
    set_lane(made.ground_reflectance, lane, stack.ground().reflectance);
    made.has_ground |= stack.ground().reflectance > 0.0;
    double ior = stack.ior_above();
    for (std::size_t k = 0; k < count; ++k) {
      const Layer& from = stack.layers()[k];
      FirstOrderLayer<V>& to = made.layers[k];
      set_lane(to.sigma_s, lane, from.medium.sigma_s);
      set_lane(to.sigma_t, lane, sigma_t(from.medium));
      set_lane(to.thickness, lane, std::min(from.thickness, half_space));
      set_lane(to.ior, lane, from.medium.ior);
      set_lane(to.inverse_ior2, lane, 1.0 / (from.medium.ior * from.medium.ior));
      to.is_matched_above &= from.medium.ior == ior;
      ior = from.medium.ior;
      const auto kinds = lobes_of(from);
      for (std::size_t l = 0; l < kinds.size(); ++l) {
        PhaseLobe<V>& lobe = made.lobes[to.first_lobe + l];
        lobe.is_rayleigh = is_rayleigh(kinds[l]);
        set_lane(lobe.weight, lane, kinds[l].weight);
        if (!lobe.is_rayleigh) set_lane(lobe.g, lane, std::get<HenyeyGreenstein>(kinds[l].phase).g);
      }
    }
    made.is_matched_below &= stack.ior_below() == ior;
    made.has_one_ior &= has_equal_indices(stack, bands.front());
  }
  bool is_matched_on = made.is_matched_below;
  for (std::size_t k = count; k-- > 0;) {
    made.layers[k].is_matched_on_below = is_matched_on || reflections == InternalReflections::lost;
    is_matched_on &= made.layers[k].is_matched_above;
  }
  return made;
}

/// Horizontal part of two directions inside a medium, multiplied.
template <class V>
V sines(const StackBeam<V>& in, const StackBeam<V>& out, const V& inverse_ior2) {
  const double outside = in.toward.x * out.toward.x + in.toward.y * out.toward.y;
  return in.ior * out.ior * inverse_ior2 * all<V>(outside);
}

template <class V>
V ground_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in, const StackBeam<V>& out) {
  return all<V>(std::numbers::inv_pi) * stack.ground_reflectance * in.ground * out.ground /
         (stack.ior_below * stack.ior_below);
}

}  // namespace

FirstOrderStack<double> make_first_order(const LayerStack& stack, InternalReflections reflections) {
  return make_stack<double>({&stack, 1}, 1, reflections);
}

template <int N>
FirstOrderStack<BandValues<N>> make_first_order(std::span<const LayerStack> bands,
                                                InternalReflections reflections) {
  return make_stack<BandValues<N>>(bands, N, reflections);
}

namespace {

double only(double value, const double*) { return value; }
template <int N>
float only(const BandValues<N>& values, const float*) {
  return values[0];
}
template <int N>
const BandValues<N>& only(const BandValues<N>& values, const BandValues<N>*) {
  return values;
}

template <class V>
struct ScalarOf {
  using type = float;
};
template <>
struct ScalarOf<double> {
  using type = double;
};

/// A boundary on a beam's way, and all that lies behind it.
template <class V>
struct Crossing {
  V mirror;   ///< reflectance of the boundary alone
  V through;  ///< flux behind it per flux that arrives, all returns summed
  V back;     ///< sent back by it and by what lies behind
  bool has_mirror, has_back;
};

/// Refraction and reflection, one after the other: for one band, G = V, or, where all bands share
/// their directions, once for all of them.
template <class G, class V>
void refract(const FirstOrderStack<V>& stack, StackBeam<V>& beam,
             InlineVector<Crossing<V>, 5>& crossings) {
  const auto index = [](const V& ior) { return only(ior, static_cast<const G*>(nullptr)); };
  const std::size_t count = stack.layers.size();
  const bool is_above = beam.toward.z >= 0.0;
  const double sine2 = beam.toward.x * beam.toward.x + beam.toward.y * beam.toward.y;
  const G one = all<G>(1.0), least = all<G>(1e-7);
  G ior = index(beam.ior), mu = index(beam.mu);
  const G invariant = all<G>(sine2) * ior * ior;
  for (std::size_t i = 0; i <= count; ++i) {
    const std::size_t boundary = is_above ? i : count - i;  // [layer below it]
    const bool is_matched =
        boundary == count ? stack.is_matched_below : stack.layers[boundary].is_matched_above;
    Crossing<V>& crossing = crossings[i];
    crossing.has_mirror = !is_matched;
    LayerBeam<V>* layer = nullptr;
    G next = ior;
    if (i < count) {
      const std::size_t k = is_above ? i : count - 1 - i;
      layer = &beam.layers[k];
      next = index(stack.layers[k].ior);
    } else if (!is_matched) {
      next = index(is_above ? stack.ior_below : stack.ior_above);
    }
    if (is_matched) {
      crossing.mirror = all<V>(0.0);
    } else {
      const G mu_next = sqrt(max(one - invariant / (next * next), all<G>(0.0)));
      crossing.mirror = widened<V>(boundary_reflectance(ior, mu, next, mu_next));
      mu = mu_next;
    }
    ior = next;
    if (!layer) continue;
    const G inside = max(mu, least);
    layer->mu = widened<V>(inside);
    layer->inverse_mu = widened<V>(one / inside);
  }
}

}  // namespace

template <class V>
StackBeam<V> make_beam(const FirstOrderStack<V>& stack, const Vec3& toward) {
  const std::size_t count = stack.layers.size();
  const bool is_above = toward.z >= 0.0;
  assert(is_above || stack.is_transmissive());
  const bool has_ladder = stack.reflections == InternalReflections::ladder;
  const V one = all<V>(1.0), zero = all<V>(0.0);
  StackBeam<V> beam;
  beam.layers.reset(count);
  beam.toward = toward;
  beam.mu = all<V>(std::max(std::abs(toward.z), 1e-7));
  beam.ior = is_above ? stack.ior_above : stack.ior_below;
  InlineVector<Crossing<V>, 5> crossings(count + 1);
  if (stack.has_one_ior)
    refract<typename ScalarOf<V>::type>(stack, beam, crossings);
  else
    refract<V>(stack, beam, crossings);

  // Layers in the order in which the light meets them. From the far side on: what each boundary and
  // all behind it send back.
  const auto at = [&](std::size_t i) { return is_above ? i : count - 1 - i; };
  V behind = zero;  // nothing comes back unscattered from a ground, or from outside
  bool has_behind = false;
  for (std::size_t i = count + 1; i-- > 0;) {
    Crossing<V>& crossing = crossings[i];
    const V& mirror = crossing.mirror;
    crossing.through = one - mirror;
    crossing.back = mirror;
    if (has_behind) {
      crossing.through = crossing.through / max(one - mirror * behind, all<V>(1e-30));
      crossing.back = mirror + (one - mirror) * behind * crossing.through;
    }
    crossing.has_back = crossing.has_mirror || has_behind;
    if (i == 0) break;
    LayerBeam<V>& layer = beam.layers[at(i - 1)];
    const FirstOrderLayer<V>& medium = stack.layers[at(i - 1)];
    layer.decay = medium.sigma_t * layer.inverse_mu;
    layer.pass = exp_minus(layer.decay * medium.thickness);
    has_behind = has_ladder && crossing.has_back;
    if (has_behind) behind = crossing.back * layer.pass * layer.pass;
  }
  beam.surface = crossings[0].mirror;
  beam.reflected = crossings[0].back;
  V flux = one;
  for (std::size_t i = 0; i < count; ++i) {
    LayerBeam<V>& layer = beam.layers[at(i)];
    flux *= crossings[i].through;
    const V entering = flux;
    flux *= layer.pass;
    const Crossing<V>& next = crossings[i + 1];
    const V returning = has_ladder && next.has_back ? flux * next.back : zero;
    layer.down = is_above ? entering : returning;
    layer.up = is_above ? returning : entering;
  }
  beam.ground = flux * crossings[count].through;
  return beam;
}

template <class V>
V first_order_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in,
                   const StackBeam<V>& out) {
  const bool are_above = in.toward.z >= 0.0 && out.toward.z >= 0.0;
  V sum = all<V>(0.0);
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    const FirstOrderLayer<V>& layer = stack.layers[k];
    const Turns<V> turn = turns(layer, in.layers[k], out.layers[k], are_above);
    const V across = V{} - sines(in, out, layer.inverse_ior2);
    const V cosines = in.layers[k].mu * out.layers[k].mu;
    sum += turn.back * layer_phase(stack, layer, max(across - cosines, all<V>(-1.0)));
    if (turn.has_on) sum += turn.on * layer_phase(stack, layer, min(across + cosines, all<V>(1.0)));
  }
  if (stack.has_ground) sum += ground_bsdf(stack, in, out);
  return out.ior * out.ior * sum;
}

template StackBeam<double> make_beam(const FirstOrderStack<double>&, const Vec3&);
template double first_order_bsdf(const FirstOrderStack<double>&, const StackBeam<double>&,
                                 const StackBeam<double>&);

#define LAMINA_FIRST_ORDER(N)                                                                      \
  template FirstOrderStack<BandValues<N>> make_first_order<N>(std::span<const LayerStack>,         \
                                                              InternalReflections);                \
  template StackBeam<BandValues<N>> make_beam(const FirstOrderStack<BandValues<N>>&, const Vec3&); \
  template BandValues<N> first_order_bsdf(const FirstOrderStack<BandValues<N>>&,                   \
                                          const StackBeam<BandValues<N>>&,                         \
                                          const StackBeam<BandValues<N>>&);
LAMINA_FIRST_ORDER(4)
LAMINA_FIRST_ORDER(8)
LAMINA_FIRST_ORDER(16)
#undef LAMINA_FIRST_ORDER

}  // namespace lamina
