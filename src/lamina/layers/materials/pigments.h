// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <span>
#include <string_view>

namespace lamina {

/// A powder, as spheres. Radii of what colors paint are those of common products, ours.
struct Pigment {
  std::string_view name;  ///< as in files
  std::complex<double> (*ior)(double wavelength);
  double median_radius;     ///< [mm]
  double sigma_log_radius;  ///< as in Particles
};

/// All pigments that files know by name.
[[nodiscard]] std::span<const Pigment> pigments();

/// Titanium dioxide as rutile at a wavelength [nm]: the mean over the directions of a uniaxial
/// crystal, (2 n_o + n_e) / 3; clear. Source: [Devore1951], formulas for 430-1530 nm. Below 430 nm
/// they are extended, and rutile begins to absorb there: paint is then too bright.
[[nodiscard]] std::complex<double> rutile_ior(double wavelength);

/// Light-absorbing carbon, 1.95 + 0.79 i at 550 nm, taken for all wavelengths.
/// Source: [BondBergstrom2006]. Spheres of it absorb about 30 % less than measured, they say.
[[nodiscard]] std::complex<double> carbon_ior(double wavelength);

/// Desert dust: 1.55 and the imaginary part that sunlight through it has at 440, 670, 870 and 1020
/// nm, over the Persian Gulf; powers of the wavelength between them, and on below 440 nm.
/// Source: [Dubovik2002], Table 1.
[[nodiscard]] std::complex<double> mineral_dust_ior(double wavelength);

/// Red iron oxide, hematite, at a wavelength [nm] in [380, 1000]: its ordinary ray.
/// Source: [Querry1985].
[[nodiscard]] std::complex<double> hematite_ior(double wavelength);

}  // namespace lamina
