// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cmath>
#include <concepts>
#include <optional>
#include <type_traits>

#include "lamina/base/core/vec.h"

namespace lamina {

// In this file `eta` is the refractive index beyond the interface over that before it, along the
// light: 1.4 for light that enters skin from air, 1 / 1.4 for light that leaves it.

/// Cosine of the angle of refraction for the cosine cos_i of the angle of incidence, in [0, 1];
/// 0 at and beyond the critical angle. Snell's law.
template <std::floating_point T>
[[nodiscard]] T cos_refracted(T cos_i, std::type_identity_t<T> eta) {
  assert(T{0} <= cos_i && cos_i <= T{1} && eta > T{0});
  const T cos2_t = T{1} - (T{1} - cos_i * cos_i) / (eta * eta);
  return cos2_t > T{0} ? std::sqrt(cos2_t) : T{0};
}

/// Unpolarized reflectance of a smooth interface between two dielectrics.
///
/// @param cos_i  cosine of the angle of incidence, in [0, 1].
/// @param eta    refractive index beyond the interface over that before it, > 0.
/// @return       reflected fraction of the flux: 1 under total internal reflection, 0 if eta = 1.
///
/// Source: [BornWolf1999] §1.5.2, Eq. 21, averaged over the two polarizations.
template <std::floating_point T>
[[nodiscard]] T fresnel(T cos_i, std::type_identity_t<T> eta) {
  if (eta == T{1}) return T{0};
  const T cos_t = cos_refracted(cos_i, eta);
  if (cos_t == T{0}) return T{1};
  const T r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const T r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return T{0.5} * (r_s * r_s + r_p * r_p);
}

/// Fraction of diffuse light that a smooth interface reflects: the integral of 2 mu fresnel(mu,
/// eta) over mu in [0, 1], in closed form.
///
/// @param eta  refractive index beyond the interface over that before it, > 0. Pass 1 / ior for
///             light inside a medium in air; total internal reflection is included.
/// @return     in [0, 1), exact to 1e-15 for all eta, near 1 too.
///
/// Source: [Duntley1942] for eta > 1, after Walsh; 1 - F(eta) = eta^2 (1 - F(1 / eta)), which is
/// reciprocity, for eta < 1.
[[nodiscard]] double fresnel_diffuse(double eta);

/// Diffuse Fresnel reflectance by the polynomials that the papers on diffusion use; to reproduce
/// them.
///
/// Off by at most 0.0017 for 1 / eta in [0.6, 2], which is its value at 1; by 0.0006 at 1.4, and
/// by 0.0052 at 2.5.
///
/// Source: [EganHilgeman1973], as quoted by [DonnerJensen2005] Eq. 5, whose second branch prints
/// the square of the index where the cube belongs.
[[nodiscard]] double fresnel_diffuse_polynomial(double eta);

/// The direction in which light that arrives from `w` goes on behind a smooth interface.
///
/// @param w    unit vector away from the surface to where the light comes from, dot(w, n) >= 0.
/// @param n    unit normal on the side of w.
/// @param eta  refractive index beyond the interface over that before it, > 0.
/// @return     unit vector away from the surface on the far side; absent under total reflection.
template <std::floating_point T>
[[nodiscard]] std::optional<BasicVec3<T>> refract(const BasicVec3<T>& w, const BasicVec3<T>& n,
                                                  std::type_identity_t<T> eta) {
  const T cos_i = dot(w, n);
  const T cos2_t = T{1} - (T{1} - cos_i * cos_i) / (eta * eta);
  if (!(cos2_t > T{0})) return std::nullopt;
  return (cos_i / eta - std::sqrt(cos2_t)) * n - w / eta;
}

}  // namespace lamina
