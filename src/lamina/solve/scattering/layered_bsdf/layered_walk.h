// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/random.h"
#include "lamina/solve/scattering/layered_bsdf/first_order.h"

namespace lamina {

/// Light below the surface followed at random through flat layers, without spread to the side: all
/// orders of scattering, with noise in place of the error that the term of higher orders has. Paths
/// start from the eye; by reciprocity they are those of the light.
///
/// All bands share a path, which is drawn by one of them; each counts by the mean density of all
/// (the balance heuristic), so that bands that differ much stay quiet.
///
/// Source: [HanrahanKrueger1993] §6, last paragraph; [Wilkie2014] for the bands.
template <int N>
class LayeredWalk {
 public:
  using Bands = BandValues<N>;

  /// The stack must outlive it, and all bands must have the same indices and thicknesses.
  /// @param wo  unit vector towards the eye, wo.z > 0.
  LayeredWalk(const FirstOrderStack<Bands>& stack, const StackBeam<Bands>& wo)
      : stack_(stack), wo_(wo) {}

  /// One random estimate of the BSDF [1/sr] from `in` to the eye, without bias: order 1 in closed
  /// form, the others by next-event estimation along one path.
  [[nodiscard]] Bands evaluate(const StackBeam<Bands>& in, Random& random) const;

  /// Follows one path until it leaves on top. weight stands for bsdf * cosine / density; 0 if it
  /// was absorbed, left below, or was not scattered at all.
  struct Exit {
    Vec3 wi;
    Bands weight;
  };
  [[nodiscard]] Exit trace(Random& random) const;

 private:
  template <class AtEvent>
  [[nodiscard]] Exit walk(Random& random, const AtEvent& at_event) const;

  const FirstOrderStack<Bands>& stack_;
  const StackBeam<Bands>& wo_;
};

}  // namespace lamina
