// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/base/core/vec.h"
#include "lamina/base/image/image.h"

namespace lamina {

/// A quadrilateral of one color in an image.
struct FlatPatch {
  Vec2 centre{};      ///< where its diagonals cross, which is so in any perspective
  double side = 0.0;  ///< root of its area [pixel]
};

/// Regions with hardly any gradient and four corners, for several meanings of hardly any.
/// @param rgb  linear, of three channels
[[nodiscard]] std::vector<FlatPatch> find_flat_patches(const Image& rgb);

}  // namespace lamina
