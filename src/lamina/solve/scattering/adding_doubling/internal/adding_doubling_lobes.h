// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina::detail {

/// The narrowest lobe that a direction grid must resolve.
struct NarrowestLobe {
  int nodes = 0;      ///< of the grid's first segment, half the azimuthal modes; 0: none
  std::string where;  ///< "layer 0" or "ground": the boundary below which
  double roughness = 0.0;
};

/// Narrowest lobe of light that meets two boundaries, a rough one at least, with nothing to scatter
/// it in between. All other light meets facets before or after something smooth, and needs no
/// resolution.
///
/// Through facets of slope s a direction's p changes by s times the difference of the indices, so
/// the lobe in p is as a Gaussian of standard deviation alpha |n1 - n2|, which a grid of n nodes
/// shows to 1 % where 2n standard deviations are 3.
[[nodiscard]] NarrowestLobe narrowest_lobe(const LayerStack& stack);

}  // namespace lamina::detail
