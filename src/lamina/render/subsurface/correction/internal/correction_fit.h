// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lamina/render/subsurface/correction/internal/directional_ratio.h"
#include "lamina/render/subsurface/correction/internal/place_graph.h"

namespace lamina {

/// Light that leaves at a point in a direction: by a random walk, and by a planar method.
template <int N>
struct WalkedSample {
  DirectionTerms terms;
  BandValues<N> walked, planar;  ///< radiance times the area that the sample stands for
  float weight = 1.0f;           ///< in the mean that the fit keeps
};

/// How light that leaves differs from that of the planar method, over the surface.
template <int N>
struct CorrectionFit {
  AngularShape<N> shape;                    ///< of all of the surface; the ratios are over it
  std::vector<DirectionalRatio<N>> ratios;  ///< [place]
  std::array<std::vector<DirectionalRatio<N>>, 2> of_halves;  ///< the same of every other sample
  double error_left = 0.0;  ///< what is still wrong, as far as halves of samples tell: root mean
                            ///< square over the mean light
};

/// Fits the ratio of walked to planar light, smooth along the surface, as widely at each place as
/// the samples there ask for: of widths that double the number of places, the one that
/// predicts best, fitted to either half of the samples, what the other half found around there.
/// What narrow widths leave is fitted a second time, which flattens less where the ratio bends. A
/// narrow fit is drawn to the wider one in how it depends on direction. The whole is scaled so that
/// the weighted mean of the samples is met, as far as it is known; what single walks bring beyond
/// ten times the light around them counts in that mean alone.
///
/// @param areas    [place], that its samples stand for [mm²]; 0: not seen, so that it has no say in
///                 which width is best, and is not counted in `error_left`
/// @param samples  [place][sample], an even number at each place, >= 2; halves are every other one
/// @param bands    of all lanes that count, >= 1
/// @param shape    that the ratios are to be over; none: the one that fits best
template <int N>
[[nodiscard]] CorrectionFit<N> fit_correction(const PlaceGraph& graph, std::span<const float> areas,
                                              std::vector<std::vector<WalkedSample<N>>> samples,
                                              int bands,
                                              const std::optional<AngularShape<N>>& shape = {});

}  // namespace lamina
