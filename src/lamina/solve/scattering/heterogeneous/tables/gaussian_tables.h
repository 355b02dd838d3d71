// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/solve/scattering/heterogeneous/tables/mapped_stack.h"
#include "lamina/solve/scattering/heterogeneous/tables/state_lattice.h"

namespace lamina {

/// Totals that the operators are scaled to.
enum class OperatorTotals {
  diffusion,           ///< those of the closed form itself
  radiative_transfer,  ///< by adding-doubling
  /// Totals by radiative transfer, and the first layer's R+ is such that the whole stack has the
  /// profile of radiative transfer, for every absorption of the first layer and the reference
  /// absorption of those below
  radiative_transfer_profile,
  /// Totals by `radiative_transfer`, of light that arrives evenly from all directions; in no file
  radiative_transfer_diffuse
};

template <>
inline constexpr auto enum_names<OperatorTotals> = std::to_array<EnumName<OperatorTotals>>(
    {{"diffusion", OperatorTotals::diffusion},
     {"radiative_transfer", OperatorTotals::radiative_transfer},
     {"radiative_transfer_profile", OperatorTotals::radiative_transfer_profile}});

/// Gaussians whose variances double, and absorptions at equal ratios.
struct GaussianTableGrid {
  double lowest = 1e-3;    ///< absorption of the first row [1/mm]
  double highest = 100.0;  ///< and of the last
  std::size_t rows = 256;
  /// [mm²]; from 1e-4 on, as in the paper, they miss what an epidermis as thick as a mean free path
  /// transmits by 1.2e-3
  double first_variance = 5e-5;
  std::size_t gaussians = 23;  ///< the paper's 18 miss the tail of a red dermis by .7 %
  double ridge = 3e-4;         ///< penalty on the size of the weights
  friend bool operator==(const GaussianTableGrid&, const GaussianTableGrid&) = default;
};

/// The states at which a layer is solved: its own, or all absorptions of a grid.
[[nodiscard]] StateLattice lattice_of(const MappedLayer& layer, const GaussianTableGrid& grid);

/// Layers between which a layer lies while it varies: its own middle state, or the
/// absorption given [1/mm].
[[nodiscard]] LayerState reference_state(const MappedLayer& layer, double sigma_a);

/// One of R+, T+, R-, T- of one layer as weights of Gaussians, for every state of a lattice.
struct GaussianTable {
  std::vector<double> weights;  ///< [node][gaussian]; the first is the delta. May be negative
  std::vector<double> error;    ///< [node] largest error over spatial frequency, of R(k = 0)
};

/// The four operators of a layer. A half-space has the first one only.
struct LayerTables {
  GaussianTable reflection_above, transmission_down, reflection_below, transmission_up;
};

/// R+, T+, R-, T- of a layer.
[[nodiscard]] inline std::array<const GaussianTable*, 4> operator_tables(const LayerTables& layer) {
  return {&layer.reflection_above, &layer.transmission_down, &layer.reflection_below,
          &layer.transmission_up};
}

/// A stack's tables.
struct StackTables {
  GaussianTableGrid grid;
  std::vector<double> variances;  ///< 0, then doubling [mm²]
  double ground_reflectance = 0.0;
  std::vector<StateLattice> lattices;  ///< [layer]
  std::vector<LayerTables> layers;
};

/// Up to where spatial frequencies are fitted [1/mm].
inline constexpr double highest_fitted_frequency = 200.0;

/// Fits the closed form of the multipole by sums of Gaussians: least squares over spatial
/// frequencies up to highest_fitted_frequency, with a small ridge, weights of either sign. Then
/// every row is scaled to its total.
///
/// Errors, of the value at k = 0, for skin of any color, epidermises of .05 to .4 mm and
/// absorptions in [.01, 30]/mm: below 4e-4 of what an epidermis transmits, below 1e-4 of what it or
/// the dermis reflects.
///
/// Totals by radiative transfer are those of each layer alone between its neighbours' indices, lit
/// normally (or evenly, as OperatorTotals says) from above the first and evenly elsewhere. Light
/// between layers is not even, by which the sum over layers errs by up to 5 %. So every layer but
/// the first gets the reflectance, and if it is finite the transmittance, with which it and those
/// above it are right, for every state of its own and one of the layers above it. A first layer
/// that has states gets those with which the whole stack is right, for every state of its own and
/// one of the layers below.
///
/// @param reference_sigma_a  [layer] the absorptions at which that holds [1/mm], of layers without
///                           states; not used for the totals of diffusion.
/// @param progress           told after each solution of radiative transfer
/// @throws InvalidInput as LayerStack; Interrupted if asked to stop.
///
/// Source: [Donner2008] §5; [DEon2007] for Gaussians; docs/heterogeneous_skin.md.
[[nodiscard]] StackTables make_stack_tables(const MappedStack& stack, OperatorTotals totals,
                                            std::span<const double> reference_sigma_a = {},
                                            const GaussianTableGrid& grid = {},
                                            const Progress& progress = {});

/// Stack tables, kept in a cache between runs.
[[nodiscard]] StackTables cached_stack_tables(const std::optional<DiskCache>& cache,
                                              const MappedStack& stack, OperatorTotals totals,
                                              std::span<const double> reference_sigma_a = {},
                                              const GaussianTableGrid& grid = {},
                                              const Progress& progress = {});

/// The weights at a place of the table's lattice, [gaussian].
[[nodiscard]] std::vector<double> weights_at(const StateLattice& lattice,
                                             const GaussianTable& table, const LatticePlace& place);

/// The weights at an absorption [1/mm] of a layer of which nothing else varies, [gaussian]: cubic
/// between rows in the logarithm, that of the first or last row beyond.
[[nodiscard]] std::vector<double> weights_at(const StackTables& tables, const GaussianTable& table,
                                             double sigma_a);

}  // namespace lamina
