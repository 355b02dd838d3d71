// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/skin/acquire/inversion/errors/posterior.h"
#include "lamina/skin/acquire/inversion/objective/map_smoothness.h"

namespace lamina::detail {

/// Smoothness of numbers of skin as they vary over forearms, [number].
[[nodiscard]] std::vector<MapSmoothness> usual_smoothness(const InversionTables& tables,
                                                          double mm_per_texel);

/// The smoothness that makes maps most likely: each weight is how many texels the images tell of
/// what it weighs over the squares of these derivatives [MacKay1992]. What the images hardly tell
/// keeps what is usual. Edges are found anew.
///
/// @param coordinates  of a solution, by the smoothness that the objective has
/// @param draw         there
[[nodiscard]] std::vector<MapSmoothness> likely_smoothness(const PatchObjective& objective,
                                                           const TexelMaps& coordinates,
                                                           const PosteriorSample& draw);

/// Lets derivatives count by less where those of the map are large, by more where they are small:
/// as if each neighborhood had a weight of its own, drawn from a gamma distribution, which makes
/// derivatives follow Student's t distribution.
void find_edges(const GridSize& size, const std::vector<float>& map, MapSmoothness& smoothness);

}  // namespace lamina::detail
