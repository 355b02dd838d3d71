// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {

/// Cosine in a medium of the direction with p = ior sin(theta), kept off 0.
inline double ray_cos(double p, double ior) {
  return std::max(std::sqrt(std::max(0.0, (1.0 - p / ior) * (1.0 + p / ior))), 1e-12);
}

/// Reflectance of interface q for direction p: 1 where one side does not have it.
inline double interface_reflectance(const GridStack& stack, std::size_t q, double p) {
  const double near = stack.ior[q], far = stack.ior[q + 1];
  if (near == far) return 0.0;
  if (p >= std::min(near, far)) return 1.0;
  return fresnel(std::min(1.0, ray_cos(p, near)), far / near);
}

}  // namespace lamina::detail
