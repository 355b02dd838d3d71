// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/render/subsurface/subsurface_method.h"
#include "lamina/solve/scattering/heterogeneous/blurs/cell_graph.h"

namespace lamina {

/// Samples of the light at a texel, as sums.
template <int N>
struct TexelSamples {
  BandValues<N> irradiance, missed;  ///< as EnteringLight has them
  float open = 0.0f, seen = 0.0f;
  /// Products of the brightness of both, for the variance.
  float irradiance2 = 0.0f, irradiance_missed = 0.0f, missed2 = 0.0f;
  int count = 0;
  bool may_have_more = true;

  void add(const EnteringLight<N>& light);
};

/// The share of an open sky that the neighbours of each texel see, [texel]: what the samples of the
/// texel missed of it, times this share, is added to its light. That takes out the noise of
/// sampling an open sky, without bias, for what neighbours see does not depend on the texel's own
/// samples: a control variate.
///
/// @param cells  the texels as cells
template <int N>
[[nodiscard]] std::vector<float> sky_shares(const CellLevel& cells,
                                            std::span<const TexelSamples<N>> samples);

/// How many more samples each texel gets, [texel], so that the error of all, over the light there,
/// gets least: by the standard deviation of samples over their mean, of some sixty texels that
/// lie together, itself left out: so what it gets does not depend on its own samples, and there is
/// no bias.
///
/// @param shares  [texel], as sky_shares has them
/// @param budget  mean over the texels that may have more, >= 0
///
/// Source: Neyman's optimal allocation.
template <int N>
[[nodiscard]] std::vector<int> more_samples(const CellGraph& graph,
                                            std::span<const TexelSamples<N>> samples,
                                            std::span<const float> shares, float budget);

/// Light that one of a texel's samples found by a rare path, as mirrored by one surface onto
/// another, is spread over the texels around: where the samples of a texel differ five times as
/// much as those of some sixty texels that lie together, and it is brighter than its neighbours, it
/// gets their mean, and all of these texels share what is left. No light is lost.
///
/// @param light  [texel], mean of the samples
template <int N>
void spread_rare_light(const CellGraph& graph, std::span<const TexelSamples<N>> samples,
                       std::span<const float> shares, std::span<BandValues<N>> light);

}  // namespace lamina
