// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace lamina {

/// 0 below 0, 1 above 1, a cubic without kinks between them.
template <class Real>
[[nodiscard]] constexpr Real smooth_step(Real x) {
  x = std::clamp(x, Real{0}, Real{1});
  return x * x * (Real{3} - Real{2} * x);
}

/// Smooth step from `low` to `high`.
template <class Real>
[[nodiscard]] constexpr Real smooth_step(Real low, Real high, Real x) {
  return smooth_step((x - low) / (high - low));
}

}  // namespace lamina
