// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lamina/layers/optics/rough/rough_interface.h"

namespace lamina {

/// How facets hide one another, and which light counts.
enum class FacetMasking {
  smith,           ///< facets at independent heights, [Smith1967]; light that meets one facet
  smith_multiple,  ///< the same with light that meets several, [Heitz2016]: nothing is lost
  v_cavity         ///< grooves of two facets, [TorranceSparrow1967]; has no transmission of its own
};

/// Fractions of the flux that an interface reflects and transmits, over the angle of incidence; for
/// smooth and rough ones, from either side. Made once, evaluated often.
struct InterfaceReflectance {
  std::vector<double> reflectance;    ///< at the cosines i / (size - 1)
  std::vector<double> transmittance;  ///< of the same size; reflectance + transmittance <= 1
  double diffuse_reflectance;         ///< for diffuse light: integral of 2 mu reflectance
  double diffuse_transmittance;
};

/// Integrates the BRDF and BTDF of an interface over their hemispheres: up to half a second where
/// it is rough, so that the last ones are kept.
///
/// With Smith's masking the two add up to less than 1, since light that meets several facets is
/// left out. With v_cavity, as [DonnerJensen2005] Eqs. 23-26 want, all that is not reflected counts
/// as transmitted.
///
/// For light from inside a medium pass eta = ior outside / ior inside; total reflection is
/// included. Error of the fractions: below 1e-3, and below 1e-4 for alpha >= 0.1.
[[nodiscard]] InterfaceReflectance make_interface_reflectance(
    const RoughInterface<double>& interface, FacetMasking masking = FacetMasking::smith);

/// Fraction of flux reflected for light from a direction of cosine cos_i, in [0, 1].
[[nodiscard]] double reflectance(const InterfaceReflectance& table, double cos_i);

/// Fraction of flux transmitted for light from a direction of cosine cos_i, in [0, 1].
[[nodiscard]] double transmittance(const InterfaceReflectance& table, double cos_i);

}  // namespace lamina
