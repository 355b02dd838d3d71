// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace lamina {

/// Scattering of a plane wave by one homogeneous sphere: cross sections over the geometric one.
struct MieSphere {
  double extinction = 0.0;  ///< efficiency, >= scattering
  double scattering = 0.0;  ///< efficiency
  double g = 0.0;           ///< mean cosine of the scattering angle
};

/// @param size_parameter  circumference over the wavelength in the surrounding medium, in (0, 1e5].
/// @param relative_ior    index of the sphere over that of the medium, real part > 0, magnitude <=
///                        100; an imaginary part >= 0 absorbs.
/// @throws InvalidInput if the series would be longer: its terms are as many as the size parameter
///         times the magnitude.
///
/// Source: [BohrenHuffman1983] Eqs. 4.52, 4.53, 4.61, 4.62; number of terms after [Wiscombe1980].
[[nodiscard]] MieSphere mie_sphere(double size_parameter, std::complex<double> relative_ior);

/// Phase function of the sphere in unpolarized light at each cosine [1/sr]; integrates to 1.
/// @throws InvalidInput as mie_sphere
/// Source: [BohrenHuffman1983] Eqs. 4.74, 4.77.
[[nodiscard]] std::vector<double> mie_phase(double size_parameter,
                                            std::complex<double> relative_ior,
                                            std::span<const double> cos_theta);

/// Spheres in a medium: pigment grains, cell organelles, fat droplets. Their radii are spread
/// log-normally by number.
struct Particles {
  double volume_fraction = 0.0;  ///< in [0, 1)
  double median_radius = 1e-3;   ///< [mm], > 0
  double sigma_log_radius =
      0.0;  ///< standard deviation of the logarithm of the radius, in [0, 1.5]
  std::complex<double> ior = 1.5;  ///< of the particles; imaginary part >= 0
};

/// Bulk coefficients of a suspension in which particles scatter independently of each other, which
/// holds for volume fractions of a few per cent; denser, both coefficients are too large.
struct MieBulk {
  double sigma_a = 0.0;  ///< [1/mm]
  double sigma_s = 0.0;  ///< [1/mm]
  double g = 0.0;
};

/// @param ior_medium  real index of what holds the particles, > 0.
/// @param wavelength  in vacuum [nm], > 0.
/// @throws InvalidInput as mie_sphere, for the largest radius of the spread: the mean by volume
///         times exp(6 sigma_log_radius).
[[nodiscard]] MieBulk mie_bulk(const Particles& particles, double ior_medium, double wavelength);

}  // namespace lamina
