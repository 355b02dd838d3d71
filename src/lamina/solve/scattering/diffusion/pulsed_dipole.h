// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/layers/optics/layer_stack.h"

namespace lamina {

/// How much of the light under a boundary leaves through it: reflectance = fluence * fluence rate +
/// flux * D d(fluence rate)/dz, both just below the boundary.
///
/// The radiance there is that of diffusion, whose integral over directions times Fresnel's
/// transmittance this is: for index 1.4 below air 0.118 and 0.306. Of a rough boundary, which turns
/// a fraction f of diffuse light back, (1 - f) / 4 and (1 - f) / 2.
///
/// Source: [KienlePatterson1997] §2.
struct EscapeWeights {
  double fluence = 0.25;
  double flux = 0.5;

  /// A, by which the boundary lengthens the distance 2 A D where the fluence vanishes: (1 + 3 I2) /
  /// (1 - 2 I1) of the integrals of Fresnel's reflectance over cosine and its square.
  /// Source: [Contini1997] §2.
  [[nodiscard]] double fluence_ratio() const { return (1.0 - flux) / (2.0 * fluence); }
};

/// @param boundary    between the two.
/// @param ior_inside, ior_outside  > 0.
[[nodiscard]] EscapeWeights make_escape_weights(const Interface& boundary, double ior_inside,
                                                double ior_outside);

/// A half-space under a short pulse in a pencil beam, by diffusion: a source and its image in the
/// plane where the fluence vanishes; one wavelength.
struct PulsedDipole {
  double source_depth;  ///< one reduced mean free path without absorption [mm]
  double image_height;  ///< of the image above the surface [mm]
  double D;             ///< diffusion coefficient, 1 / (3 sigma_s') whatever absorbs [mm]
  double speed;         ///< of light in the medium [mm/ps]
  double sigma_a;       ///< [1/mm]
  EscapeWeights escape;
};

/// @param layer  an infinitely thick one whose medium scatters.
[[nodiscard]] PulsedDipole make_pulsed_dipole(const Layer& layer, double ior_outside);

/// Light that leaves per area and time at distance r [mm], a time t [ps] after the pulse, per
/// entered light [1/(mm² ps)]; 0 for t <= 0.
///
/// Holds for times of many reduced mean free paths; before r / speed it shows light that is faster
/// than light.
///
/// Source: [Contini1997] Eqs. 33 and 36 with m = 0, weighted as in [KienlePatterson1997].
[[nodiscard]] double pulsed_reflectance(const PulsedDipole& dipole, double r, double t);

}  // namespace lamina
