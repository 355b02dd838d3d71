// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"

namespace lamina::detail {

/// Diffuse light from above on one point, or a beam that a rough top spreads, that is scattered
/// once and neither before nor after reflected, for any spatial frequency.
///
/// What comes to a depth and what leaves from there are alike: straight rays that go aside. So the
/// response is an integral over depth of two sums over directions, which meet in each azimuthal
/// mode of the phase function.
struct DiffuseSingle {
  /// The straight rays between one side of the stack and depths in a layer, [depth][node].
  struct Rays {
    std::size_t nodes = 0;
    std::vector<double> light;  ///< with the weight of the node
    std::vector<double> aside;  ///< [mm]
  };
  struct Layer {
    double strength = 0.0;
    std::vector<double> depth_weight;  ///< [depth] [mm]
    Rays from_top, from_bottom;        ///< the latter without nodes if no light leaves there
    Rays to_top;                       ///< without nodes if as those from there
    const std::vector<PhaseMode>* phase = nullptr;
    int modes = 0;  ///< highest that counts
  };
  std::vector<Layer> layers;
};

/// @param solver      with some 24 nodes or more; must outlive the result.
/// @param extinction  [layer] of unscattered light [1/mm]
/// @param depth_nodes of each panel of depths, which double in width from the faces on
[[nodiscard]] DiffuseSingle make_diffuse_single(const FrequencySolver& solver,
                                                const std::vector<double>& extinction,
                                                int depth_nodes = 8);
[[nodiscard]] FrequencyResponse single_response(const DiffuseSingle& single, double k);

/// Single scattering as all orders have it on a grid, with the azimuths that the modes can tell
/// apart: what is to be taken out of `diffuse_responses`.
[[nodiscard]] FrequencyResponse diffuse_single_on_grid(const FrequencySolver& solver, double k);

}  // namespace lamina::detail
