// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/photon_bands/band_photons.h"

#include <cmath>

#include "lamina/base/core/random.h"

namespace lamina {

std::uint64_t seed_of_band(std::uint64_t seed, std::size_t band) {
  std::uint64_t result = seed;
  for (std::uint64_t state = seed, i = 0; i < band; ++i) result = Random::splitmix(state);
  return result;
}

std::vector<MonteCarloResult> trace_bands(std::span<const LayerStack> bands,
                                          const MonteCarloOptions& options, bool are_independent) {
  const auto count = static_cast<double>(bands.size());
  std::vector<MonteCarloResult> results;
  for (std::size_t band = 0; band < bands.size(); ++band) {
    MonteCarloOptions of_band = options;
    if (are_independent) of_band.seed = seed_of_band(options.seed, band);
    of_band.seconds /= count;
    const auto begun = static_cast<double>(band);
    of_band.progress = part_of(options.progress, begun / count, (begun + 1.0) / count);
    results.push_back(trace_photons(bands[band], of_band));
  }
  return results;
}

SlabTotals slab_totals(const MonteCarloResult& result, double Estimate::*part) {
  SlabTotals totals{.specular_reflectance = result.specular_reflectance.*part,
                    .diffuse_reflectance = result.diffuse_reflectance.*part,
                    .transmittance = result.transmittance.*part};
  for (const Estimate& layer : result.absorptance) totals.absorptance.push_back(layer.*part);
  return totals;
}

LogBins bins_around(const RadialGrid& grid) {
  const std::vector<double> r = radii(grid);
  const double half = std::sqrt(r[1] / r[0]);
  return {static_cast<int>(r.size()), r.front() / half, r.back() * half};
}

Profile photon_profile(std::span<const MonteCarloResult> bands, const RadialGrid& grid,
                       double Estimate::*part) {
  Profile profile{.per = ProfilePer::arriving_flux, .bands = bands.size(), .r = radii(grid)};
  for (std::size_t i = 0; i < profile.r.size(); ++i)
    for (const MonteCarloResult& band : bands) {
      profile.reflectance_profile.push_back(band.log_radial.reflection[i].*part);
      profile.transmittance_profile.push_back(band.log_radial.transmission[i].*part);
    }
  for (const MonteCarloResult& band : bands) {
    // As of the other profiles, without what the lit surface mirrors.
    profile.total_reflectance.push_back(band.diffuse_reflectance.*part);
    profile.total_transmittance.push_back(band.transmittance.*part);
  }
  return profile;
}

}  // namespace lamina
