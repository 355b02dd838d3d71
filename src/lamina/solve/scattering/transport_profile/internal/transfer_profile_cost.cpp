// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {
namespace {

/// Per doubling and cube of the states; measured over three stacks of 40 to 360 states, which were
/// not kept. benchmarks/transfer_profile_benchmark shows the time of one.
constexpr double seconds_per_unit = 2e-10;
constexpr double other_steps = 6.0;         ///< of a layer, in doublings
constexpr double endless_doublings = 25.0;  ///< until nothing comes through
constexpr double most_seconds = 600.0, most_mebibytes = 2048.0;

}  // namespace

SolutionCost solution_cost(std::span<const LayerStack> stacks, int nodes, int modes,
                           int frequencies) {
  SolutionCost cost;
  for (const LayerStack& stack : stacks) {
    const std::vector<double> ior = merged_indices(stack);
    const DirectionGrid grid = make_direction_grid(ior, nodes);
    double values = 0.0, largest = 0.0;
    for (std::size_t l = 0; l < stack.layers().size(); ++l) {
      const Layer& layer = stack.layers()[l];
      const double states = static_cast<double>(active_count(grid, ior[l + 1])) * (modes + 1);
      const double doublings =
          std::isfinite(layer.thickness)
              ? std::log2(1.0 + 100.0 * sigma_t(layer.medium) * layer.thickness)
              : endless_doublings;
      cost.seconds +=
          seconds_per_unit * std::pow(states, 3.0) * (doublings + other_steps) * frequencies;
      values += 4.0 * states * states;
      largest = std::max(largest, states * states);
    }
    cost.mebibytes = std::max(cost.mebibytes, thread_count() * (values + 8.0 * largest) *
                                                  sizeof(double) / (1024.0 * 1024.0));
  }
  return cost;
}

void require_affordable(const SolutionCost& cost) {
  if (cost.seconds <= most_seconds && cost.mebibytes <= most_mebibytes) return;
  throw InvalidInput(printf_text(
      "radiative transfer: this stack takes at least some %.0f min of one core and %.2g GiB, "
      "but must take at most %.0f min and %.0f GiB; fewer layers of different ior take "
      "less",
      cost.seconds / 60.0, cost.mebibytes / 1024.0, most_seconds / 60.0, most_mebibytes / 1024.0));
}

}  // namespace lamina::detail
