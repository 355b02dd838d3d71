// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"
#include "lamina/scene/description/scene.h"

namespace lamina {

/// Value of a noise map at a point in space.
///
/// @param position   [mm]
/// @param footprint  width of the region seen [mm]; features finer than twice that fade to their
///                   mean, so that the noise does not alias.
/// @return  smooth: about normal with mean 0 and standard deviation 1 (without fading);
///          cellular: in [0, 1], 0 at the scattered points and 1 half a `size` away from them.
///
/// Source: smooth is gradient noise, [Perlin2002]; cellular is [Worley1996], cut off at a radius
/// that eight cells cover.
[[nodiscard]] float evaluate_noise(const NoiseMap& noise, const Vec3f& position, float footprint);

}  // namespace lamina
