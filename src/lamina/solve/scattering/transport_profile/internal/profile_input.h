// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina::detail {

/// @throws InvalidInput naming the band for an accuracy or a stack that has no profile by radiative
/// transfer.
void check_profile_input(std::span<const LayerStack> stacks, const TransferProfileOptions& options);

/// Light that the profile adds up to: what leaves scattered; of diffuse light, and under a rough
/// top, all but what the surface alone throws back.
[[nodiscard]] FrequencyResponse flux_of_profile(const AddingDoublingTotals& solved,
                                                const LayerStack& stack, Illumination illumination);

}  // namespace lamina::detail
