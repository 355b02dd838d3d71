// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace lamina {

/// The number that an sRGB file holds for linear light, both as fractions of white; negative light
/// is mirrored. Source: [IEC61966-2-1] Eqs. 5, 6.
[[nodiscard]] inline double srgb_encode(double linear) {
  const double light = std::abs(linear);
  const double encoded =
      light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
  return std::copysign(encoded, linear);
}

/// The linear light that a number in an sRGB file stands for.
///
/// srgb_encode returns it to 3e-8 near the joint of the two branches, whose rounded constants do
/// not quite meet, and to rounding elsewhere. Source: [IEC61966-2-1] Eqs. 7, 8.
[[nodiscard]] inline double srgb_decode(double encoded) {
  const double value = std::abs(encoded);
  const double linear = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  return std::copysign(linear, encoded);
}

}  // namespace lamina
