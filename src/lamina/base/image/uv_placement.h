// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/vec.h"

namespace lamina {

/// How an image lies on texture coordinates: uv -> u u_axis + v v_axis + shift, all with v upward.
struct UvPlacement {
  Vec2f u_axis{1, 0}, v_axis{0, 1};  ///< images of the axes
  Vec2f shift{0, 0};
  friend bool operator==(const UvPlacement&, const UvPlacement&) = default;
};

[[nodiscard]] inline Vec2f place_uv(const UvPlacement& placement, Vec2f uv) {
  return uv.x * placement.u_axis + uv.y * placement.v_axis + placement.shift;
}

}  // namespace lamina
