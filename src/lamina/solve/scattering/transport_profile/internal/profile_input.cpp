// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/profile_input.h"

#include <algorithm>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"

namespace lamina::detail {
namespace {

constexpr int nodes_of_coarsest = 6, modes_of_coarsest = 4;  ///< profile

}  // namespace

void check_profile_input(std::span<const LayerStack> stacks,
                         const TransferProfileOptions& options) {
  if (!(1e-4 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-4, 0.1], but is " +
                       number_text(options.accuracy));
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const std::string band = "band " + std::to_string(b);
    const bool scatters = std::any_of(stacks[b].layers().begin(), stacks[b].layers().end(),
                                      [](const Layer& l) { return l.medium.sigma_s > 0.0; });
    if (!scatters) throw InvalidInput(band + ": at least one layer must scatter, but none does");
  }
  require_affordable(solution_cost(stacks, nodes_of_coarsest, modes_of_coarsest, 24));
}

FrequencyResponse flux_of_profile(const AddingDoublingTotals& solved, const LayerStack& stack,
                                  Illumination illumination) {
  const SlabTotals& totals = solved.totals;
  const Layer& first = stack.layers().front();
  if (illumination == Illumination::diffuse ||
      is_rough(first.top, stack.ior_above(), first.medium.ior))
    return {totals.diffuse_reflectance, totals.transmittance};
  return {
      totals.specular_reflectance + totals.diffuse_reflectance - solved.unscattered_reflectance,
      totals.transmittance - (1.0 - stack.ground().reflectance) * solved.unscattered_transmittance};
}

}  // namespace lamina::detail
