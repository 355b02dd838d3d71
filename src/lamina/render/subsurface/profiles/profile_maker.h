// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "lamina/core/progress.h"
#include "lamina/io/disk_cache.h"
#include "lamina/materials/material.h"
#include "lamina/scattering/profile/profile.h"
#include "lamina/scene/scene.h"

namespace lamina {

/// Makes the profile of a layered material, all bands, as rendering wants it: of diffuse light, per
/// flux that entered, all directions of exit together.
using ProfileMaker = std::function<Profile(const Material&)>;

/// By radiative transfer, to some 2 % from 0.02 mm on; kept in the cache. The surface and the
/// lowest boundary count as smooth, their roughness being the renderer's business.
/// @throws InvalidInput if a band does not scatter, or a boundary inside is rough; Interrupted if
///         progress asks to stop.
[[nodiscard]] Profile diffuse_transfer_profile(const Material& material,
                                               const std::optional<DiskCache>& cache,
                                               const Progress& progress = {});

/// By layered diffusion, in a millisecond.
[[nodiscard]] Profile diffusion_profile(const Material& material);

/// The maker that a scene asks for; what takes long reports to `progress`. Profiles by diffusion
/// get the totals of radiative transfer for skin whose constants are made for them, see
/// skin_totals.h.
[[nodiscard]] ProfileMaker profile_maker(const RenderSettings& settings,
                                         const Progress& progress = {});

}  // namespace lamina
