// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "lamina/base/image/image.h"

namespace lamina {

/// A map of one number as a picture: dark violet at `low` and below, by green to yellow at `high`
/// and above; transparent where `is_shown` says no. Channels R, G, B, A as save_png takes them.
///
/// The colors are those of viridis [Smith2015], which rise evenly in lightness.
/// @param map       its first channel
/// @param low,high  low < high
/// @param is_shown  by index of the pixel; empty: all are
[[nodiscard]] Image map_picture(const Image& map, double low, double high,
                                const std::function<bool(std::size_t)>& is_shown = {});

/// Map colors from low to high as a CSS gradient, for legends.
[[nodiscard]] std::string map_gradient();

}  // namespace lamina
