// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lamina/scene/scene.h"

namespace lamina {

/// For the method layered_bsdf, which looks maps up point by point as textures: the scene with the
/// maps of its recipes of skin as maps of layers. Absent if the scene has another method or none
/// such, and can be taken as it is.
[[nodiscard]] std::optional<Scene> with_skin_maps_as_layer_maps(const Scene& scene);

}  // namespace lamina
