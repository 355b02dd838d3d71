// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/gaussian_profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"

namespace lamina {
namespace {

/// Of the widest Gaussian, times the square of the slowest effective transport coefficient. Far out
/// light falls as exp(-sigma_tr r) / r²; the Gaussians that make it up are narrower than that:
/// test GaussianProfile.IsTheTransferProfile.
constexpr double widest_variance = 16.0;

/// Variances in a geometric series from the finest to the widest scale of the stacks, and 0.
std::vector<double> fitting_variances(std::span<const LayerStack> stacks, int count) {
  double densest = 0.0, slowest = INFINITY;
  for (const LayerStack& stack : stacks) {
    const auto grid = detail::make_frequency_grid(detail::make_grid_stack(stack, 2, {}), 1, 1.0);
    densest = std::max(densest, grid.highest);
    slowest = std::min(slowest, 2.0 * grid.scale);
  }
  const double first = 0.25 / (densest * densest);
  const double last = std::max(widest_variance / (slowest * slowest), 4.0 * first);
  std::vector<double> variances{0.0};
  for (int i = 0; i < count; ++i)
    variances.push_back(first * std::pow(last / first, count > 1 ? i / (count - 1.0) : 0.5));
  return variances;
}

}  // namespace

GaussianProfile fit_gaussian_profile(std::span<const LayerStack> stacks, int count,
                                     const TransferProfileOptions& options) {
  assert(count >= 1);
  GaussianProfile profile{.variances = fitting_variances(stacks, count)};
  const std::vector<double> k = fit_frequencies(profile.variances, 40);
  const auto response = spatial_frequency_response(stacks, k, options);
  const std::size_t bands = stacks.size();
  const auto fit = [&](const std::vector<double>& values) {
    std::vector<GaussianFit> fits;
    for (std::size_t band = 0; band < bands; ++band) {
      std::vector<double> spectrum;
      for (std::size_t i = 0; i < k.size(); ++i) spectrum.push_back(values[i * bands + band]);
      fits.push_back(fit_gaussians(spectrum, k, profile.variances));
    }
    return fits;
  };
  profile.reflectance = fit(response.reflectance);
  if (std::ranges::any_of(response.transmittance, [](double t) { return t > 0.0; }))
    profile.transmittance = fit(response.transmittance);
  return profile;
}

}  // namespace lamina
