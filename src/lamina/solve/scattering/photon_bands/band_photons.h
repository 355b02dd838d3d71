// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lamina/base/core/estimate.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/profile/hankel.h"
#include "lamina/solve/scattering/profile/profile.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina {

/// Seed that gives a band random numbers of its own.
[[nodiscard]] std::uint64_t seed_of_band(std::uint64_t seed, std::size_t band);

/// trace_photons of several bands, one after the other, [band]. All have the same random numbers,
/// so that their errors go together and differences of bands are smoother, unless the bands are to
/// be independent.
///
/// @param options  of each band, but seconds, which are for all of them together.
/// @throws InvalidInput as trace_photons.
[[nodiscard]] std::vector<MonteCarloResult> trace_bands(std::span<const LayerStack> bands,
                                                        const MonteCarloOptions& options,
                                                        bool are_independent = false);

/// The totals of a run, or their standard errors.
/// @param part  &Estimate::value or &Estimate::standard_error
[[nodiscard]] SlabTotals slab_totals(const MonteCarloResult& result, double Estimate::*part);

/// Bins of PhotonTallies::log_r around the radii of a grid.
/// @throws InvalidInput as `radii`.
[[nodiscard]] LogBins bins_around(const RadialGrid& grid);

/// The profile per arriving flux, or its standard errors, of bands traced with bins_around(grid),
/// [band]. Light that leaves unscattered is in the totals, but not in the profile.
[[nodiscard]] Profile photon_profile(std::span<const MonteCarloResult> bands,
                                     const RadialGrid& grid, double Estimate::*part);

}  // namespace lamina
