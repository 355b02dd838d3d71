// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "lamina/base/core/vec.h"

namespace lamina::detail {

/// A direction after scattering by an angle, at an azimuth [rad] around it.
[[nodiscard]] inline Vec3 turned(const Vec3& w, double cos_theta, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - cos_theta * cos_theta));
  return normalize(make_frame(w).to_world({sine * std::cos(phi), sine * std::sin(phi), cos_theta}));
}

}  // namespace lamina::detail
