// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_solver.h"

namespace lamina::detail {

/// A half-space and slabs of its material, each with the layers above the last on both sides. From
/// slab to slab the inner layer, which is the last of the half-space, is thicker by sqrt(2). All
/// boundaries are smooth.
struct SlabFamily {
  FrequencySolver slab, half_space;
  std::size_t inner = 0;  ///< index of the layer whose thickness varies
  double thinnest = 0.0;  ///< of that layer [mm]
  std::size_t slabs = 0;  ///< number of them

  /// Thickness of the inner layer of a slab [mm].
  [[nodiscard]] double inner_thickness(std::size_t slab_index) const;
};

/// @param half_space  semi-infinite, smooth
/// @param thinnest    slab of it, symmetric
[[nodiscard]] SlabFamily make_slab_family(const LayerStack& half_space, const LayerStack& thinnest,
                                          std::size_t slabs, int nodes, int modes);

/// Responses of a family to diffuse light from above.
struct FamilyResponse {
  FrequencyResponse half_space;
  std::vector<FrequencyResponse> slabs;
};

/// Solves the whole family at several frequencies, for little more than its half-space: doubling
/// the inner layer passes by every other slab, and two such ladders by all.
///
/// The slabs are symmetric. With equal light from both sides each half sees the response R + T of
/// the inner layer between coats, with opposite light R - T; half the sum and half the difference
/// are what leaves above and below.
[[nodiscard]] std::vector<FamilyResponse> family_responses(const SlabFamily& family,
                                                           std::span<const double> frequencies);

}  // namespace lamina::detail
