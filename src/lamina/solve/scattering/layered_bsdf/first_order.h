// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/base/core/inline_vector.h"
#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/optics/layer_stack.h"

// Everything here is written once for V = double, one band at full precision, and V =
// BandValues<N>, the bands of a rendering pass side by side in single precision.

namespace lamina {

/// Treatment of light that a boundary inside the stack reflects.
enum class InternalReflections {
  lost,   ///< as printed by [HanrahanKrueger1993]: every boundary only weakens what crosses it
  summed  ///< all reflections before and after the event are summed; nothing of order 1 is missing
};

/// One kind of particle in a layer.
template <class V>
struct PhaseLobe {
  V weight{};  ///< fraction of the layer's sigma_s
  V g{};
  bool is_rayleigh = false;
};

template <class V>
struct FirstOrderLayer {
  V sigma_s{}, sigma_t{};  ///< [1/mm]
  V thickness{};           ///< [mm]; a very large number for a half-space
  V ior{}, inverse_ior2{};
  std::size_t first_lobe = 0, lobes = 0;  ///< in FirstOrderStack::lobes
  bool is_matched_above = false;          ///< the boundary above does nothing, in all bands
  bool is_matched_on_below = false;       ///< nor does any boundary below
};

/// The media of a stack side by side, outside above, layers, outside below, where all bands share
/// their indices; for each also the next one.
struct StackMedia {
  static constexpr int most = 8;
  using Each = BandValues<most>;
  Each ior{}, next_ior{};
  Each ratio2[2],
      next_ratio2[2];  ///< (index of the outside / ior)^2, for light from above or below
};

/// A layer stack as the first-order formulas want it.
template <class V>
struct FirstOrderStack {
  InlineVector<FirstOrderLayer<V>, 4> layers;
  InlineVector<PhaseLobe<V>, 6> lobes;
  V ior_above{}, ior_below{};
  V ground_reflectance{};
  StackMedia media;               ///< of band 0
  bool is_matched_below = false;  ///< the boundary under the last layer does nothing
  bool has_one_ior = true;        ///< for all bands: they share all directions
  bool is_semi_infinite = false;
  bool has_ground = false;
  InternalReflections reflections = InternalReflections::summed;

  /// Whether a boundary does nothing, in all bands; that of index k lies on layer k.
  [[nodiscard]] bool is_matched_at(std::size_t k) const {
    return k < layers.size() ? layers[k].is_matched_above : is_matched_below;
  }
  /// Whether light leaves below.
  [[nodiscard]] bool is_transmissive() const { return !is_semi_infinite && !has_ground; }
};

/// @throws InvalidInput if a boundary inside the stack is rough. A rough top is taken as a smooth
///         one: who has a model of it scales what crosses.
[[nodiscard]] FirstOrderStack<double> make_first_order(
    const LayerStack& stack, InternalReflections reflections = InternalReflections::summed);

/// The bands of a material in one, at most N and all of one build. Lanes beyond repeat the last.
template <int N>
[[nodiscard]] FirstOrderStack<BandValues<N>> make_first_order(
    std::span<const LayerStack> bands,
    InternalReflections reflections = InternalReflections::summed);

/// Unscattered light of one direction in one layer, for unit flux from outside. By reciprocity also
/// the fraction of light inside, going the other way, that leaves there unscattered.
template <class V>
struct LayerBeam {
  V mu, inverse_mu;  ///< |cosine| inside
  V decay;           ///< sigma_t / mu [1/mm]
  V pass;            ///< exp(-decay * thickness)
  V down, up;        ///< flux going down at the layer's top, and going up at its bottom
};

/// Unscattered light of one direction in the whole stack: the zeroth order.
template <class V>
struct StackBeam {
  InlineVector<LayerBeam<V>, 4> layers;
  V ground;     ///< flux that arrives on the ground, or leaves on the far side
  V reflected;  ///< flux sent back to the side that the light came from
  V surface;    ///< of that, by the boundary that it meets first
  Vec3 toward;  ///< away from the stack; z < 0: below
  V mu;         ///< |toward.z|
  V ior;        ///< of the outside that it is in
};

/// @param toward  unit vector away from the stack, to where the light comes from or goes to; z < 0
///                is below, for stacks that transmit.
///
/// Source: [HanrahanKrueger1993] Eq. 11 with the path length of the refracted ray, which the print
/// has at normal incidence only; the sum of interreflections is a geometric series at each
/// boundary.
template <class V>
[[nodiscard]] StackBeam<V> make_beam(const FirstOrderStack<V>& stack, const Vec3& toward);

/// Radiance leaving along `out` per irradiance from `in` [1/sr], of light scattered once, and of
/// light that met nothing but a Lambertian ground once. Both may be on either side of the stack.
///
/// Reciprocal: f(in, out) / ior_out^2 is symmetric, to rounding.
///
/// Source: [HanrahanKrueger1993] Eqs. 12-13 and Figure 6. The print's delta beam is divided out and
/// all angles inside are refracted ones: as printed, with outside angles, the value is off by n^2
/// mu' / mu. Differences of exponentials are written so that equal angles need no special case.
template <class V>
[[nodiscard]] V first_order_bsdf(const FirstOrderStack<V>& stack, const StackBeam<V>& in,
                                 const StackBeam<V>& out);

/// Density of a layer's scattering over the sphere [1/sr], where it turns light by angles of these
/// 1 - cos.
template <class V>
[[nodiscard]] V layer_phase(const FirstOrderStack<V>& stack, const FirstOrderLayer<V>& layer,
                            const V& one_minus_cos);

/// Mean of first_order_bsdf over azimuth.
[[nodiscard]] double mean_first_order_bsdf(const FirstOrderStack<double>& stack,
                                           const StackBeam<double>& in,
                                           const StackBeam<double>& out);

/// Flux scattered once of a beam that arrives along `in`, on the side of `in` or on the other one.
[[nodiscard]] double first_order_flux(const FirstOrderStack<double>& stack,
                                      const StackBeam<double>& in, bool is_same_side);

}  // namespace lamina
