// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lamina/render/subsurface/irradiance_cloud.h"
#include "lamina/scene/render_options.h"
#include "lamina/scene/scene.h"

namespace lamina {

/// The light that the cache of the options keeps, if there is one and it is of use for the scene.
/// Where there is one of no use, on_notice is told why.
///
/// @param misfit  says why clouds cannot serve this picture; empty text: they can
/// @throws InvalidInput if the options need the cache and it is of no use or not there
/// @throws as load_irradiance_clouds
[[nodiscard]] std::optional<std::vector<IrradianceCloud>> find_kept_light(
    const Scene& scene, const RenderOptions& options,
    const std::function<std::string(const std::vector<IrradianceCloud>&)>& misfit);

/// Keeps light in the cache, if the options name one. @throws WriteError
void keep_light(const Scene& scene, const RenderOptions& options,
                const std::vector<IrradianceCloud>& clouds);

/// The cloud of a material; null if there is none.
[[nodiscard]] const IrradianceCloud* cloud_of(const std::vector<IrradianceCloud>& clouds,
                                              std::uint32_t material);

}  // namespace lamina
