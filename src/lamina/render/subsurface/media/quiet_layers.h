// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/materials/material.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Simplified layers for walks, where only the effect of a curved surface on its
/// light is asked for: with the boundary of the first layer, smooth, and no others. Most of the
/// noise of walks is spared, and what flat layers make of the difference is known.
[[nodiscard]] Material quiet_layers(Material material);

/// Whether that spares much: in one layer, for the radiance field, and in maps.
[[nodiscard]] bool is_better_quiet(const SubsurfaceSurface& surface);

}  // namespace lamina
