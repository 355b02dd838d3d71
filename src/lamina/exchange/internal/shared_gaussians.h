// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/solve/scattering/profile/profile.h"

namespace lamina::detail {

/// Sums of Gaussians that channels share but for the weights.
struct SharedGaussians {
  std::vector<double> variances;             ///< [i] [mm²], ascending, > 0
  std::vector<std::vector<double>> weights;  ///< [channel][i], flux, >= 0
  double largest_error = 0.0;  ///< of the flux beyond any radius, over the total of its channel
};

/// The few Gaussians whose flux beyond every radius is nearest to that of a profile, by least
/// squares with weights that are not negative. Of a Gaussian it is w exp(-r² / (2 v)), so that the
/// fit over radius has the form that fit_gaussians has over spatial frequency. The variances are a
/// geometric series, of which the first and the last are those that leave the least.
[[nodiscard]] SharedGaussians fit_shared_gaussians(const Profile& profile, bool reflected,
                                                   int count);

}  // namespace lamina::detail
