// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lamina/layers/optics/rough/rough_interface.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/spatial_frequency/illumination.h"

namespace lamina::detail {

/// How light that spreads over directions gets in by the top of a stack, and out by it: flux per
/// etendue inside, over that of diffuse light outside, and the fraction that leaves.
///
/// A smooth top has 1 - Fresnel for both, with diffuse light. A rough one spreads a beam, too.
struct TopPassage {
  std::vector<double> in, out;  ///< [node]; 0 at the beams
  bool is_rough = false;

  /// Passage in at any p of the first layer, of rough tops.
  [[nodiscard]] double in_at(double p) const;
  [[nodiscard]] double out_at(double p) const;

  // What in_at and out_at go by.
  RoughInterface<double> boundary;     ///< for light from above
  double ior = 1.0;                    ///< of the first layer
  double of_beam = 0.0;                ///< in_at over btdf; 0 for diffuse light
  std::array<double, 4> by_several{};  ///< light of a beam that meets several facets: a polynomial
                                       ///< in the cosine inside
  std::vector<double> cos, leaving;    ///< `out` over the cosine inside, ascending
};

[[nodiscard]] bool has_rough_top(const GridStack& stack);

/// @param first_mode  the rough boundaries of the stack for azimuthal mode 0.
[[nodiscard]] TopPassage make_top_passage(const GridStack& stack, const RoughBoundaries& first_mode,
                                          Illumination illumination);

}  // namespace lamina::detail
