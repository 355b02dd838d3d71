// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamina {

/// The float nearest to a value brought into [low, high], that lies in it: float(0.05) does not lie
/// in [0, 0.05].
/// @param low, high  at least one float lies between them
[[nodiscard]] inline float float_within(double value, double low, double high) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(std::clamp(value, low, high));
  if (static_cast<double>(nearest) > high) return std::nextafter(nearest, -infinity);
  if (static_cast<double>(nearest) < low) return std::nextafter(nearest, infinity);
  return nearest;
}

}  // namespace lamina
