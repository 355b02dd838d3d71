// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/medium.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"

namespace lamina {

/// A half-space under a pencil beam, replaced by two point sources; one wavelength.
struct Dipole {
  double z_r;           ///< depth of the real source below the surface [mm]
  double z_v;           ///< height of its mirror image above the surface [mm]
  double sigma_tr;      ///< effective transport coefficient [1/mm]
  double albedo_prime;  ///< reduced albedo, in (0, 1]
};

/// @param medium       must scatter; sigma_a may be 0.
/// @param ior_outside  index above the half-space, > 0.
[[nodiscard]] Dipole make_dipole(const Medium& medium, double ior_outside,
                                 const DiffusionOptions& options = {});

/// Diffuse reflectance per unit area at distance r [mm] from a normally incident pencil beam.
///
/// @return  flux leaving per unit area for unit entered flux [1/mm²].
///
/// Holds where scattering dominates and r > mfp_prime; nearer, single scattering is missing.
///
/// Source: [DonnerJensen2005] Eq. 3. The print subtracts the second term; with z_v taken
/// positive it is added, else a half-space without absorption would reflect nothing.
[[nodiscard]] double reflectance_profile(const Dipole& dipole, double r);

/// Reflectance over spatial frequency k [1/mm], k >= 0: the integral of 2 pi r J0(k r) times the
/// profile, in closed form. The fraction of the flux that returns if it enters as J0(k r).
[[nodiscard]] double reflectance_at_frequency(const Dipole& dipole, double k);

/// Fraction of the entered flux that returns: the value at k = 0.
///
/// Source: [Jensen2001] Eq. 15 in terms of z_r and z_v.
[[nodiscard]] double total_reflectance(const Dipole& dipole);

}  // namespace lamina
