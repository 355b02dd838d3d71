// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lamina/solve/scattering/diffusion/diffusion_profile.h"
#include "lamina/solve/scattering/diffusion/dipole.h"

namespace lamina {

/// The dipole that stands for a stack where layers are not known: of a single layer its own, made
/// infinitely thick; of several that of their `equivalent_half_space`.
[[nodiscard]] Dipole single_layer_dipole(const LayerStack& stack,
                                         const DiffusionOptions& options = {});

/// Profiles of those dipoles, one stack per band, per entered flux. What a finite stack of
/// thickness d transmits at r is the dipole's reflectance at r + d.
///
/// Source: [DonnerJensen2005] §2.1, which compares the multipole with this.
/// @throws InvalidInput as make_diffusion_profile.
[[nodiscard]] Profile make_dipole_profile(std::span<const LayerStack> stacks,
                                          const DiffusionOptions& options = {},
                                          const RadialGrid& grid = {});

}  // namespace lamina
