// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "monte_carlo_method.h"

#include <fmt/core.h>

#include <cmath>

#include "lamina/core/error.h"
#include "lamina/core/random.h"

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
  if (effort.has_independent_bands)
    for (std::uint64_t state = common.seed, i = 0; i < band; ++i)
      options.seed = Random::splitmix(state);
  options.relative_error = effort.relative_error;
  options.seconds = effort.seconds;
  return options;
}

MonteCarloTotals monte_carlo_totals(std::span<const LayerStack> bands, const Incidence& incidence,
                                    const MonteCarloEffort& effort, const CommonOptions& common) {
  MonteCarloTotals result;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    MonteCarloOptions options = monte_carlo_options(effort, common, i);
    options.incidence = incidence;
    options.seconds /= static_cast<double>(bands.size());
    options.progress = make_progress("photons");
    const MonteCarloResult band = trace_photons(bands[i], options);
    const auto read = [&](double Estimate::*part) {
      SlabTotals totals{.specular_reflectance = band.specular_reflectance.*part,
                        .diffuse_reflectance = band.diffuse_reflectance.*part,
                        .transmittance = band.transmittance.*part};
      for (const Estimate& layer : band.absorptance) totals.absorptance.push_back(layer.*part);
      return totals;
    };
    result.totals.push_back(read(&Estimate::value));
    result.standard_error.push_back(read(&Estimate::standard_error));
    result.unfinished.push_back(band.unfinished.value);
  }
  return result;
}

MonteCarloProfile monte_carlo_profile(std::span<const LayerStack> bands, double first, double last,
                                      int size, const MonteCarloEffort& effort,
                                      const CommonOptions& common) {
  if (!(first > 0.0 && last > first && size >= 2))
    throw InvalidInput(fmt::format(
        "--r-min, --r-max, --radii: must be 0 < r-min < r-max and at least 2, but are {}, {}, {}",
        first, last, size));
  const double ratio = std::pow(last / first, 1.0 / (size - 1));  // bins around the radii
  const LogBins bins = {size, first * std::pow(ratio, -0.5), last * std::pow(ratio, 0.5)};
  MonteCarloProfile result;
  const auto n = static_cast<std::size_t>(size);
  for (Profile* profile : {&result.profile, &result.standard_error}) {
    profile->per = ProfilePer::arriving_flux;
    profile->bands = bands.size();
    for (int i = 0; i < size; ++i) profile->r.push_back(first * std::pow(ratio, i));
    profile->reflectance_profile.resize(n * bands.size());
    profile->transmittance_profile.resize(n * bands.size());
  }
  for (std::size_t band = 0; band < bands.size(); ++band) {
    MonteCarloOptions options = monte_carlo_options(effort, common, band);
    options.tallies.log_r = bins;
    options.seconds /= static_cast<double>(bands.size());
    options.progress = make_progress("photons");
    const MonteCarloResult traced = trace_photons(bands[band], options);
    result.unfinished.push_back(traced.unfinished.value);
    const auto fill = [&](Profile& profile, double Estimate::*part) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = i * bands.size() + band;
        profile.reflectance_profile[at] = traced.log_radial.reflection[i].*part;
        profile.transmittance_profile[at] = traced.log_radial.transmission[i].*part;
      }
      // As of the other profiles, without what the lit surface mirrors.
      profile.total_reflectance.push_back(traced.diffuse_reflectance.*part);
      profile.total_transmittance.push_back(traced.transmittance.*part);
    };
    fill(result.profile, &Estimate::value);
    fill(result.standard_error, &Estimate::standard_error);
  }
  return result;
}

}  // namespace lamina::cli
