// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_totals.h"

namespace lamina::detail {

/// @throws InvalidInput if the angle is out of range.
void require_incidence(const Incidence& incidence);

/// The beams of incidences, in their order; diffuse ones take none.
[[nodiscard]] std::vector<GridDirection> beams_of(const LayerStack& stack,
                                                  std::span<const Incidence> incidences);

/// Unit flux from above, over the square root of the nodes' etendues: of the beam of that number on
/// the grid, or diffuse.
[[nodiscard]] std::vector<double> incident_state(const GridStack& stack,
                                                 std::optional<std::size_t> beam_number);

/// Totals of such light. Nodes and errors are left to the caller.
[[nodiscard]] AddingDoublingTotals totals_of(const GridStack& on_grid,
                                             const StackOperators& operators,
                                             std::vector<double> down);

}  // namespace lamina::detail
