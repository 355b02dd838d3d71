// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "lamina/scene/description/scene.h"

namespace lamina {

/// The quantity of layers that a map of a material's numbers is, for the method layered_bsdf, which
/// looks maps up point by point as textures; of coefficients the map over its mean, a factor.
///
/// @param material  its name, for errors
/// @param image     index of the map's values among the images
/// @throws InvalidInput for a map that this method does not have: of g, of one value per band, of
///         recipes of leaves, of inks.
[[nodiscard]] LayerMap layer_map(const MaterialMap& from, const std::string& material,
                                 std::size_t image);

}  // namespace lamina
