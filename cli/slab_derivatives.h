// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "console.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/layer_stack.h"
#include "lamina/solve/scattering/adding_doubling_derivatives/adding_doubling_derivatives.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

// `lamina slab --derivatives`.

namespace lamina::cli {

/// Derivatives of the totals of stacks, [band].
/// @throws InvalidInput as adding_doubling_derivatives, naming the band; Interrupted.
[[nodiscard]] std::vector<AddingDoublingDerivatives> slab_derivatives(
    const Material& material, const std::vector<LayerStack>& stacks, const Incidence& incidence,
    const AddingDoublingOptions& options);

/// [total][by what][layer][band], per mm and mm.
[[nodiscard]] JsonOutput derivatives_json(const std::vector<AddingDoublingDerivatives>& bands);

/// Changes of the totals for one percent more of each number, in percent of the total.
[[nodiscard]] std::string derivatives_text(const Material& material,
                                           const std::vector<LayerStack>& stacks,
                                           const std::vector<AddingDoublingDerivatives>& bands);

}  // namespace lamina::cli
