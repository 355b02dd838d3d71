// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/materials/material.h"

namespace lamina {

/// The measured materials of [Jensen2001] Figure 5 as half-spaces with names as jensen_apple.
///
/// The paper measures the reduced scattering coefficient; it stands here under sigma_s with g = 0,
/// which is the same to every diffusion model. Solvers that follow single directions see isotropic
/// scattering. The bands are the channels of its camera, taken for linear RGB.
[[nodiscard]] std::vector<Material> jensen2001_materials();

}  // namespace lamina
