// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// For the method layered_bsdf, which looks maps up point by point as textures: the scene with the
/// maps of its materials as maps of layers. Absent if the scene has another method or none such,
/// and can be taken as it is.
/// @throws InvalidInput for a map that this method does not have: of g, of one value per band, of
///         recipes of leaves, of inks.
[[nodiscard]] std::optional<Scene> with_material_maps_as_layer_maps(const Scene& scene);

}  // namespace lamina
