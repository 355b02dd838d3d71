// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lamina/base/core/float_pi.h"
#include "lamina/base/core/vec.h"

namespace lamina {

/// A direction around +z with density cos / pi.
[[nodiscard]] inline Vec3f sample_cosine_hemisphere(Vec2f u) {
  // Concentric map of the square to the disc: it keeps the strata of the samples compact.
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  float r = 0.0f, phi = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    r = a;
    phi = 0.25f * float_pi * (b / a);
  } else if (b != 0.0f) {
    r = b;
    phi = 0.5f * float_pi - 0.25f * float_pi * (a / b);
  }
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1.0f - r * r))};
}

}  // namespace lamina
