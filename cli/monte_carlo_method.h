// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "console.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/profile.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::cli {

/// Effort of a Monte Carlo method: --photons, --relative-error, --time,
/// --independent-bands.
struct MonteCarloEffort {
  std::optional<double> photons;  ///< per band; as typed, so that 1e6 will do
  double relative_error = 0.0;
  double seconds = 0.0;
  bool has_independent_bands = false;  ///< else all bands have the same random numbers
};

/// Adds these options; `effort` must outlive the parse.
void add_effort_options(const Command& command, MonteCarloEffort& effort);

/// For a band, or a run of several.
/// @throws InvalidInput if --photons is no number of photons.
[[nodiscard]] MonteCarloOptions monte_carlo_options(const MonteCarloEffort& effort,
                                                    const CommonOptions& common,
                                                    std::size_t band = 0);

/// A remark on light that was given up after very many events; empty if there is none.
[[nodiscard]] std::string unfinished_remark(double part);

/// Totals with their standard errors, [band].
struct MonteCarloTotals {
  std::vector<SlabTotals> totals, standard_error;
  std::vector<double> unfinished;  ///< light given up after very many events
};

[[nodiscard]] MonteCarloTotals monte_carlo_totals(std::span<const LayerStack> bands,
                                                  const Incidence& incidence,
                                                  const MonteCarloEffort& effort,
                                                  const CommonOptions& common);

/// Profiles per arriving flux with their standard errors, by exit radii on a logarithmic grid.
/// Light that leaves unscattered is in the totals, but not in the profile.
struct MonteCarloProfile {
  Profile profile, standard_error;
  std::vector<double> unfinished;  ///< [band] light given up after very many events
};

/// @throws InvalidInput as `radii` of the grid.
[[nodiscard]] MonteCarloProfile monte_carlo_profile(std::span<const LayerStack> bands,
                                                    const RadialGrid& grid,
                                                    const MonteCarloEffort& effort,
                                                    const CommonOptions& common);

}  // namespace lamina::cli
