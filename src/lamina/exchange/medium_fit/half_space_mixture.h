// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lamina/exchange/medium_fit/channel_light.h"
#include "lamina/exchange/medium_fit/homogeneous_fit.h"

namespace lamina {

/// Homogeneous half-spaces of which a walk takes one at random where it enters: together they
/// return light as layers do.
struct HalfSpaceMixture {
  std::vector<std::vector<Medium>> media;    ///< [medium][channel], denser ones first
  std::vector<std::vector<double>> weights;  ///< [medium][channel], >= 0, of sum 1 in a channel
  std::vector<ChannelMisfit> misfits;        ///< [channel]
};

/// The mixture of three (or fewer, where fewer do) whose profile is nearest, per channel, by least
/// squares over albedos, mean free paths and weights, with the total met.
///
/// @param fit  one medium for the same light, thick; it lends index and g, and starts the search.
/// @throws Interrupted.
///
/// Source: the idea is [AliagaJarabo2026]'s; they learn the media, here they are fitted to profiles
/// by radiative transfer.
[[nodiscard]] HalfSpaceMixture fit_half_space_mixture(const ChannelLight& light,
                                                      const HomogeneousFit& fit,
                                                      const Progress& progress = {});

}  // namespace lamina
