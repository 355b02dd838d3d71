// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

// Henyey and Greenstein's phase function of 1 - cos of the angle by which light turns, in single or
// double precision. A cosine near 1 has no digits left where the forward peak is sharp: in single
// precision its density is 14 % off at g = 0.999.

namespace lamina {

/// 1 - cos of the angle between two directions of unit length, with all its digits.
/// @tparam Vector  Vec3 or Vec3f.
template <class Vector>
[[nodiscard]] auto one_minus_cos(const Vector& a, const Vector& b) {
  const Vector apart = a - b;
  const auto square = dot(apart, apart);
  return square / decltype(square)(2);
}

/// Density over the sphere [1/sr], for the mean cosine g in (-1, 1).
///
/// Source: [HenyeyGreenstein1941] Eq. 2, with 1 + g^2 - 2 g cos = (1 - g)^2 + 2 g (1 - cos).
template <class Real>
[[nodiscard]] Real henyey_greenstein(Real g, Real one_minus_cos) {
  const Real off = Real(1) - g, d = off * off + (g + g) * one_minus_cos;
  return Real(0.25) * std::numbers::inv_pi_v<Real> * off * (Real(1) + g) / (d * std::sqrt(d));
}

/// 1 - cos of an angle drawn from it, by u in [0, 1).
///
/// Source: [Witt1977], solved for 1 - cos, which needs no case for g = 0 and does not cancel.
template <class Real>
[[nodiscard]] Real sample_henyey_greenstein(Real g, Real u) {
  const Real v = u + u, off = Real(1) - g, d = Real(1) + g - g * v;
  return off * off * v * (Real(1) + g - Real(0.5) * g * v) / (d * d);
}

}  // namespace lamina
