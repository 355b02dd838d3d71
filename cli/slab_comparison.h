// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "console.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::cli {

/// Totals by adding-doubling, by that many photons and by diffusion, side by side, with differences
/// from adding-doubling: of Monte Carlo in its standard errors, of diffusion in percent.
///
/// @param stacks  [band] of the material.
void run_slab_comparison(const Material& material, const std::vector<LayerStack>& stacks,
                         const Incidence& incidence, std::int64_t photons,
                         const CommonOptions& options);

}  // namespace lamina::cli
