// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/io/json_output.h"
#include "lamina/layers/materials/material.h"

namespace lamina {

/// A scene that shows what a material looks like, as a scene file says it: a ball of 20 mm, lit by
/// a window on the left and, from behind, by a lamp on the right, whose light comes through the rim
/// of what is translucent. Layers that are all finite are a thin shell.
///
/// @param side  of the picture [pixel], >= 1
[[nodiscard]] JsonOutput swatch_scene(const Material& material, int side);

}  // namespace lamina
