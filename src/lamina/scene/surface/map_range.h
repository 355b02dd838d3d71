// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>

#include "lamina/scene/description/scene.h"
#include "lamina/scene/surface/texture.h"

namespace lamina {

/// The lowest and the highest value that a sum of terms can have; of noise, all but one point in a
/// thousand.
[[nodiscard]] std::pair<float, float> range_of(const TextureStore& textures,
                                               std::span<const ScalarParameter> terms);

/// Range of a color, each channel by itself.
[[nodiscard]] std::pair<Vec3f, Vec3f> range_of(const TextureStore& textures,
                                               const ColorParameter& color);

}  // namespace lamina
