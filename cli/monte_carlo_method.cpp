// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "monte_carlo_method.h"

#include <fmt/core.h>

#include <cmath>

#include "lamina/base/core/error.h"
#include "lamina/solve/scattering/photon_bands/band_photons.h"

namespace lamina::cli {

void add_effort_options(const Command& command, MonteCarloEffort& effort) {
  const std::string group = "Monte Carlo";
  command.add_option("--photons", effort.photons, "photons per band; 1e6 if nothing is said")
      .type_name("N")
      .group(group);
  command
      .add_option("--relative-error", effort.relative_error,
                  "stop when reflectance and transmittance are known to this fraction")
      .type_name("E")
      .range(1e-9, 1.0)
      .group(group);
  command.add_option("--time", effort.seconds, "stop after so many seconds")
      .type_name("S")
      .range(1e-3, 1e9)
      .group(group);
  command
      .add_flag("--independent-bands", effort.has_independent_bands,
                "other random numbers in each band; else the errors of all bands go together, and "
                "differences of bands are smoother")
      .group(group);
}

std::string unfinished_remark(double part) {
  if (!(part > 0.0)) return "";
  return fmt::format("{:.2g} of the light was given up unfinished, after {} events", part,
                     MonteCarloOptions{}.max_events);
}

MonteCarloOptions monte_carlo_options(const MonteCarloEffort& effort, const CommonOptions& common,
                                      std::size_t band) {
  MonteCarloOptions options;
  // With a precision or a time to reach, photons are without limit unless one is given.
  if (effort.relative_error > 0.0 || effort.seconds > 0.0) options.photons = 1'000'000'000'000;
  if (effort.photons) {
    const double n = *effort.photons;
    if (!(n >= 1.0 && n <= 1e15 && n == std::floor(n)))
      throw InvalidInput(
          fmt::format("--photons: must be a whole number in [1, 1e15], but is {}", n));
    options.photons = static_cast<std::uint64_t>(n);
  }
  options.seed = common.seed;
  if (effort.has_independent_bands) options.seed = seed_of_band(common.seed, band);
  options.relative_error = effort.relative_error;
  options.seconds = effort.seconds;
  return options;
}

MonteCarloTotals monte_carlo_totals(std::span<const LayerStack> bands, const Incidence& incidence,
                                    const MonteCarloEffort& effort, const CommonOptions& common) {
  MonteCarloOptions options = monte_carlo_options(effort, common);
  options.incidence = incidence;
  options.progress = make_progress("photons");
  MonteCarloTotals result;
  for (const MonteCarloResult& band : trace_bands(bands, options, effort.has_independent_bands)) {
    result.totals.push_back(slab_totals(band, &Estimate::value));
    result.standard_error.push_back(slab_totals(band, &Estimate::standard_error));
    result.unfinished.push_back(band.unfinished.value);
  }
  return result;
}

MonteCarloProfile monte_carlo_profile(std::span<const LayerStack> bands, const RadialGrid& grid,
                                      const MonteCarloEffort& effort, const CommonOptions& common) {
  MonteCarloOptions options = monte_carlo_options(effort, common);
  options.tallies.log_r = bins_around(grid);
  options.progress = make_progress("photons");
  const std::vector<MonteCarloResult> traced =
      trace_bands(bands, options, effort.has_independent_bands);
  MonteCarloProfile result{photon_profile(traced, grid, &Estimate::value),
                           photon_profile(traced, grid, &Estimate::standard_error)};
  for (const MonteCarloResult& band : traced) result.unfinished.push_back(band.unfinished.value);
  return result;
}

}  // namespace lamina::cli
