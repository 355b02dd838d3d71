// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

#include <cassert>
#include <string>
#include <type_traits>
#include <variant>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/layered_bsdf/internal/first_order_beam-inl.h"

namespace lamina {
namespace {

using namespace first_order::HWY_NAMESPACE;

constexpr double half_space = 1e12;  // [mm], thicker than anything seen through

void set_lane(double& value, std::size_t, double x) { value = x; }
template <int N>
void set_lane(BandValues<N>& value, std::size_t lane, double x) {
  value.v[lane] = static_cast<float>(x);
}

std::vector<PhaseMixture::Lobe> lobes_of(const Layer& layer) {
  return std::visit(
      [](const auto& kind) -> std::vector<PhaseMixture::Lobe> {
        if constexpr (std::is_same_v<decltype(kind), const PhaseMixture&>)
          return kind.lobes;
        else
          return {{.weight = 1.0, .phase = kind}};
      },
      phase_function(layer));
}

/// Writes the numbers of one wavelength of a lobe: `PhaseLobe` knows these kinds alone.
template <typename V>
void set_lobe(PhaseLobe<V>& lobe, std::size_t lane, const HenyeyGreenstein& phase) {
  set_lane(lobe.g, lane, phase.g);
}
template <typename V>
void set_lobe(PhaseLobe<V>& lobe, std::size_t, const Rayleigh&) {
  lobe.is_rayleigh = true;
}

void require_smooth_inside(const LayerStack& stack) {
  const auto require = [](const Interface& boundary, const std::string& where) {
    if (boundary.roughness > 0.0)
      throw InvalidInput(where +
                         ": first order needs smooth boundaries below the top, but the "
                         "roughness is " +
                         number_text(boundary.roughness));
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
      is_same = of_a[l].phase.index() == of_b[l].phase.index();
  }
  if (!is_same) throw InvalidInput("bands: all must have the same layers and kinds of particles");
}

bool has_equal_indices(const LayerStack& a, const LayerStack& b) {
  for (std::size_t k = 0; k < a.layers().size(); ++k)
    if (a.layers()[k].medium.ior != b.layers()[k].medium.ior) return false;
  return a.ior_above() == b.ior_above() && a.ior_below() == b.ior_below();
}

StackMedia media_of(const LayerStack& stack) {
  StackMedia media;
  const auto ior_of = [&](int m) {
    if (m == 0) return stack.ior_above();
    const auto k = static_cast<std::size_t>(m - 1);
    return k < stack.layers().size() ? stack.layers()[k].medium.ior : stack.ior_below();
  };
  for (int m = 0; m < StackMedia::most; ++m) {
    const double ior = ior_of(m), next = ior_of(m + 1);
    set_lane(media.ior, static_cast<std::size_t>(m), ior);
    set_lane(media.next_ior, static_cast<std::size_t>(m), next);
    for (const int side : {0, 1}) {
      const double outside = side == 0 ? stack.ior_above() : stack.ior_below();
      set_lane(media.ratio2[side], static_cast<std::size_t>(m), outside * outside / (ior * ior));
      set_lane(media.next_ratio2[side], static_cast<std::size_t>(m),
               outside * outside / (next * next));
    }
  }
  return media;
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
        set_lane(lobe.weight, lane, kinds[l].weight);
        std::visit([&](const auto& phase) { set_lobe(lobe, lane, phase); }, kinds[l].phase);
      }
    }
    made.is_matched_below &= stack.ior_below() == ior;
    made.has_one_ior &= has_equal_indices(stack, bands.front());
  }
  made.media = media_of(bands.front());
  bool is_matched_on = made.is_matched_below;
  for (std::size_t k = count; k-- > 0;) {
    made.layers[k].is_matched_on_below = is_matched_on || reflections == InternalReflections::lost;
    is_matched_on &= made.layers[k].is_matched_above;
  }
  return made;
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

template <class V>
StackBeam<V> make_beam(const FirstOrderStack<V>& stack, const Vec3& toward) {
  return beam_toward(stack, toward);
}

template <class V>
V first_order_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in,
                   const StackBeam<V>& out) {
  return V(bsdf(stack, in, out));
}

template <class V>
V layer_phase(const FirstOrderStack<V>& stack, const FirstOrderLayer<V>& layer,
              const V& one_minus_cos) {
  return V(phases<V, LanesOf<V>, 1>(stack, layer, {one_minus_cos})[0]);
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
                                          const StackBeam<BandValues<N>>&);                        \
  template BandValues<N> layer_phase(const FirstOrderStack<BandValues<N>>&,                        \
                                     const FirstOrderLayer<BandValues<N>>&, const BandValues<N>&);
LAMINA_FIRST_ORDER(4)
LAMINA_FIRST_ORDER(8)
LAMINA_FIRST_ORDER(16)
#undef LAMINA_FIRST_ORDER

}  // namespace lamina
