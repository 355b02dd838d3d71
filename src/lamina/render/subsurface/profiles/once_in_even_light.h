// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// The share of light that is scattered once where flat layers lie in even light: of the light of
/// each direction in which it leaves, over what the boundary lets through. Boundaries below the
/// first count as matched, as SingleScattering has it.
///
/// Source: [HanrahanKrueger1993] Eq. 12, in the closed form of first_order_bsdf.
template <int N>
class OnceInEvenLight {
 public:
  /// @param stacks  [band]
  explicit OnceInEvenLight(std::span<const LayerStack> stacks);

  [[nodiscard]] BandValues<N> share(float cos_o) const;
  /// Largest share of all directions.
  [[nodiscard]] BandValues<N> largest_share() const;

 private:
  static constexpr int nodes = 17;
  std::array<BandValues<N>, nodes> shares_;  ///< at even cosines, of which the first is next to 0
};

}  // namespace lamina
