// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "lamina/base/core/vec.h"

namespace lamina {

struct Ray {
  Vec3f origin;
  Vec3f direction;  ///< unit length
};

/// Where a ray meets a triangle.
struct Hit {
  float distance = std::numeric_limits<float>::infinity();  ///< [mm]
  float u = 0.0f, v = 0.0f;  ///< barycentric weights of the second and third vertex
  std::uint32_t mesh = 0, triangle = 0;
  [[nodiscard]] bool is_hit() const { return distance < std::numeric_limits<float>::infinity(); }
};

}  // namespace lamina
