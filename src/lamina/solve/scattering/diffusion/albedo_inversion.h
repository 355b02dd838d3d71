// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lamina/base/core/bracketed_root.h"
#include "lamina/layers/optics/medium.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

namespace lamina {

/// The reduced albedo at which a model has a given total reflectance.
struct AlbedoInversion {
  double albedo_prime;  ///< in [0, 1]
  double residual;      ///< of the reflectance there
  bool converged;       ///< false if no albedo gives so much or so little: then the nearest end
};

/// Solves model(albedo_prime) = reflectance.
///
/// @param model        total reflectance for a reduced albedo in [0, 1], growing with it.
/// @param reflectance  to be met within 1e-12.
///
/// The unknown is u = sqrt(1 - albedo'): over it a diffuse reflectance is smooth up to white, where
/// its slope over the albedo is infinite.
template <class Model>
[[nodiscard]] AlbedoInversion invert_albedo(const Model& model, double reflectance) {
  const auto [u, residual] =
      falling_root([&](double at) { return model(1.0 - at * at) - reflectance; }, 0.0, 1.0, 1e-13);
  return {1.0 - u * u, residual, std::abs(residual) < 1e-12};
}

/// Inverts the albedo by the dipole, a half-space of index `ior_inside` under `ior_outside`.
///
/// Source: the inverse of [Jensen2001] Eq. 15, which [JensenBuhler2002] and [Hery2003] tabulate.
[[nodiscard]] AlbedoInversion invert_dipole_albedo(double reflectance, double ior_inside,
                                                   double ior_outside,
                                                   const DiffusionOptions& options = {});

/// A medium as artists ask for it, by its look.
struct DiffuseLook {
  double reflectance;  ///< total diffuse reflectance per entered flux, in [0, 1)
  double diffuse_mfp;  ///< 1 / sigma_tr, how far diffused light spreads [mm], > 0
};

/// The medium whose half-space has that look by the dipole.
///
/// @param g    mean cosine that it shall have, in (-1, 1); ior its index.
/// @throws InvalidInput if the look cannot be: a white medium spreads without end.
///
/// Source: [JensenBuhler2002] §5, [Hery2003] §2.
[[nodiscard]] Medium medium_from_look(const DiffuseLook& look, double g, double ior,
                                      double ior_outside, const DiffusionOptions& options = {});

/// The half-space that looks most like a stack of layers if one layer must do: of the same total
/// reflectance, and falling to half of it at the same spatial frequency.
[[nodiscard]] Medium equivalent_half_space(const LayerStack& stack,
                                           const DiffusionOptions& options = {});

}  // namespace lamina
