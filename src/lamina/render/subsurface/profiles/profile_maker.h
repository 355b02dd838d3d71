// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "lamina/core/progress.h"
#include "lamina/io/disk_cache.h"
#include "lamina/materials/material.h"
#include "lamina/scattering/profile/profile.h"
#include "lamina/scene/scene.h"

namespace lamina {

/// Makes the profile of layers, [band], as rendering wants it: of diffuse light, per flux that
/// entered, all directions of exit together. The layers are those of a material, or made of them;
/// what its recipe says decides on their totals.
using ProfileMaker =
    std::function<Profile(const Material& material, std::span<const LayerStack> bands)>;

/// By radiative transfer, to some 2 % from 0.02 mm on; kept in the cache. The surface and the
/// lowest boundary count as smooth, their roughness being the renderer's business.
/// @throws InvalidInput if a band does not scatter, or a boundary inside is rough; Interrupted if
///         progress asks to stop.
[[nodiscard]] Profile diffuse_transfer_profile(std::span<const LayerStack> bands,
                                               const std::optional<DiskCache>& cache,
                                               const Progress& progress = {});

/// Of a material by layered diffusion, in a millisecond.
[[nodiscard]] Profile diffusion_profile(const Material& material);

/// The maker that a scene asks for; what takes long reports to `progress`. Profiles by diffusion
/// get the totals of radiative transfer for skin whose constants are made for them, see
/// skin_totals.h.
[[nodiscard]] ProfileMaker profile_maker(const RenderSettings& settings,
                                         const Progress& progress = {});

}  // namespace lamina
