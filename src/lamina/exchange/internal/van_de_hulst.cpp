// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/internal/van_de_hulst.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lamina {

double van_de_hulst_color(double albedo, double g) {
  assert(0.0 <= albedo && albedo <= 1.0 && -1.0 < g && g < 1.0);
  const double s = std::sqrt((1.0 - albedo) / (1.0 - g * albedo));
  return (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
}

double van_de_hulst_albedo(double color, double g) {
  assert(0.0 <= color && color <= 1.0 && -1.0 < g && g < 1.0);
  const double s =
      4.09712 + 4.20863 * color - std::sqrt(9.59217 + color * (41.6808 + color * 17.7126));
  return std::clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 1.0);
}

}  // namespace lamina
