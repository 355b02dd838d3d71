// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lamina/solve/scattering/profile/gaussian_fit.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina {

/// A material's profiles by radiative transfer as sums of Gaussians that its bands share but for
/// the weights.
struct GaussianProfile {
  std::vector<double> variances;           ///< [i] [mm²]; the first is 0
  std::vector<GaussianFit> reflectance;    ///< [band], per arriving flux
  std::vector<GaussianFit> transmittance;  ///< [band]; empty if no band transmits
};

/// Fits straight to what the solver has at spatial frequencies: nothing is sampled over radius, and
/// no transform comes between.
///
/// The narrowest Gaussian is as wide as half a mean free path in the densest layer of all bands,
/// each next one by the same factor wider, up to four lateral decay lengths in the clearest band.
///
/// @param count  of Gaussians besides that of variance 0, >= 1.
/// @throws InvalidInput as `transfer_profile`.
///
/// Errors are relative to the value at k = 0, over 40 frequencies in a geometric series.
[[nodiscard]] GaussianProfile fit_gaussian_profile(std::span<const LayerStack> stacks, int count,
                                                   const TransferProfileOptions& options = {});

}  // namespace lamina
