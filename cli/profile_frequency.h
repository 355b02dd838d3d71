// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "console.h"
#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/transport_profile/transfer_profile.h"

namespace lamina::cli {

/// `lamina profile --domain frequency`: what spatial-frequency domain imaging measures, at
/// frequencies from 1 / the last radius to 1 / the first.
/// @param has_derivatives  also print them, by what layers are made of
/// @param head             what the JSON starts with after the method
void run_profile_frequency(const Material& material, const RadialGrid& grid,
                           const TransferProfileOptions& options, bool has_derivatives,
                           const JsonOutput& head, const CommonOptions& common);

/// `lamina profile --gaussians N`.
void run_profile_gaussians(const Material& material, int count,
                           const TransferProfileOptions& options, const JsonOutput& head,
                           const CommonOptions& common);

}  // namespace lamina::cli
