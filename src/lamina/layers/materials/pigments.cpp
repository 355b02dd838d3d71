// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/pigments.h"

#include <array>
#include <cmath>

#include "lamina/layers/materials/chromophore_tables.h"

namespace lamina {
namespace {

// Source: [Querry1985], alpha-Fe2O3, ordinary ray, as collected in [Polyanskiy2024] (CC0).
/// Refractive index.
const EvenTable hematite_n = {
    .first = 380.0,
    .step = 10.0,
    .values = {
        2.545, 2.645, 2.756, 2.863, 2.962, 3.052, 3.126, 3.181, 3.217, 3.242, 3.264, 3.280, 3.282,
        3.272, 3.262, 3.266, 3.286, 3.318, 3.348, 3.361, 3.348, 3.312, 3.265, 3.218, 3.175, 3.135,
        3.102, 3.074, 3.051, 3.029, 3.008, 2.990, 2.972, 2.956, 2.942, 2.929, 2.916, 2.903, 2.892,
        2.882, 2.872, 2.862, 2.853, 2.845, 2.838, 2.833, 2.828, 2.824, 2.820, 2.816, 2.813, 2.809,
        2.805, 2.801, 2.798, 2.794, 2.791, 2.789, 2.787, 2.784, 2.781, 2.778, 2.775,
    }};

/// Absorption index, the imaginary part.
const EvenTable hematite_k = {
    .first = 380.0,
    .step = 10.0,
    .values = {
        1.258, 1.291, 1.294, 1.271, 1.231, 1.173, 1.101, 1.020, 0.943, 0.874, 0.809, 0.741, 0.675,
        0.622, 0.587, 0.564, 0.538, 0.498, 0.437, 0.357, 0.274, 0.202, 0.149, 0.114, 0.089, 0.073,
        0.065, 0.057, 0.051, 0.043, 0.038, 0.034, 0.031, 0.028, 0.026, 0.024, 0.022, 0.021, 0.020,
        0.020, 0.019, 0.019, 0.020, 0.022, 0.024, 0.025, 0.026, 0.027, 0.027, 0.026, 0.026, 0.026,
        0.024, 0.024, 0.023, 0.023, 0.023, 0.022, 0.021, 0.020, 0.018, 0.017, 0.015,
    }};

constexpr Pigment all_pigments[] = {
    {"titanium_dioxide", rutile_ior, 1e-4, 0.3},
    {"carbon_black", carbon_ior, 4e-5, 0.4},
    {"red_iron_oxide", hematite_ior, 7e-5, 0.4},
    // The coarse mode of [Dubovik2002], by volume 2.54 µm: exp(-3 sigma²) of that by number.
    {"mineral_dust", mineral_dust_ior, 8.32e-4, 0.61},
};

}  // namespace

std::span<const Pigment> pigments() { return all_pigments; }

std::complex<double> rutile_ior(double wavelength) {
  const double square = wavelength * wavelength * 1e-6;  // of the wavelength in micrometres
  const double n_o = std::sqrt(5.913 + 0.2441 / (square - 0.0803));
  const double n_e = std::sqrt(7.197 + 0.3322 / (square - 0.0843));
  return (2.0 * n_o + n_e) / 3.0;
}

std::complex<double> carbon_ior(double /*wavelength*/) { return {1.95, 0.79}; }

std::complex<double> mineral_dust_ior(double wavelength) {
  constexpr double n = 1.55;
  if (wavelength >= 870.0) return {n, 0.0010};
  const bool is_short = wavelength < 670.0;
  const auto [at, k, next, next_k] = is_short ? std::array{440.0, 0.0025, 670.0, 0.0014}
                                              : std::array{670.0, 0.0014, 870.0, 0.0010};
  return {n, k * std::pow(next_k / k, std::log(wavelength / at) / std::log(next / at))};
}

std::complex<double> hematite_ior(double wavelength) {
  return {interpolate(hematite_n, wavelength), interpolate(hematite_k, wavelength)};
}

}  // namespace lamina
