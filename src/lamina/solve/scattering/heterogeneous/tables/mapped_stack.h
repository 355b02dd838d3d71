// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina {

/// A layer that is a map; one wavelength. Unless it has `states`, its absorption varies while all
/// else is the same everywhere.
struct MappedLayer {
  double sigma_s;    ///< [1/mm], > 0
  double g;          ///< in (-1, 1)
  double ior;        ///< > 0
  double thickness;  ///< [mm], > 0; may be infinite
  /// All that the layer is anywhere, in place of sigma_s, g and thickness. Infinite thickness does
  /// not vary.
  std::optional<StateLattice> states = {};
};

/// Layers from the lit surface downward, with smooth boundaries but for the first one, of which
/// `states` may say that it is rough.
struct MappedStack {
  double ior_above = 1.0;
  std::vector<MappedLayer> layers;  ///< at least one; only the last may be infinite
  double ior_below = 1.0;
  double ground_reflectance = 0.0;  ///< Lambertian, under a last layer that is finite
  MicrofacetDistribution distribution = MicrofacetDistribution::beckmann;  ///< of a rough surface
};

/// Layers lit from below; there is no ground.
[[nodiscard]] inline MappedStack flipped(MappedStack stack) {
  assert(stack.ground_reflectance == 0.0);
  std::ranges::reverse(stack.layers);
  std::swap(stack.ior_above, stack.ior_below);
  return stack;
}

}  // namespace lamina
