// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/snow.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/layers/materials/chromophore_tables.h"
#include "lamina/layers/materials/pigments.h"
#include "lamina/layers/optics/mie.h"

namespace lamina {
namespace {

constexpr double ice_density = 917.0;    // [kg/m³]
constexpr double soot_density = 1800.0;  // [BondBergstrom2006]
constexpr double dust_density = 2600.0;  // [Hess1998]
constexpr double path_lengthening = 1.6, ice_g = 0.82;

constexpr SnowParameterRange snow_ranges[] = {
    {"grain_radius", &SnowParameters::grain_radius, 0.02, 5.0, true},
    {"density", &SnowParameters::density, 10.0, 700.0},
    {"soot", &SnowParameters::soot, 0.0, 1000.0},
    {"dust", &SnowParameters::dust, 0.0, 100'000.0},
    {"thickness", &SnowParameters::thickness, 0.1, 1e6, true},
};

// Source: [WarrenBrandt2008], ice at -7 °C, as collected in [Polyanskiy2024] (CC0).
const EvenTable ice_k = {
    .first = 390.0,
    .step = 10.0,
    .values = {
        2.000e-11, 2.365e-11, 2.669e-11, 3.135e-11, 4.140e-11, 6.268e-11, 9.239e-11, 1.325e-10,
        1.956e-10, 2.861e-10, 4.172e-10, 5.889e-10, 8.036e-10, 1.076e-9,  1.409e-9,  1.813e-9,
        2.289e-9,  2.839e-9,  3.461e-9,  4.159e-9,  4.930e-9,  5.730e-9,  6.890e-9,  8.580e-9,
        1.040e-8,  1.220e-8,  1.430e-8,  1.660e-8,  1.890e-8,  2.090e-8,  2.400e-8,  2.900e-8,
        3.440e-8,  4.030e-8,  4.300e-8,  4.920e-8,  5.870e-8,  7.080e-8,  8.580e-8,  1.020e-7,
        1.180e-7,  1.340e-7,  1.400e-7,  1.430e-7,  1.450e-7,  1.510e-7,  1.830e-7,  2.150e-7,
        2.650e-7,  3.350e-7,  3.920e-7,  4.200e-7,  4.440e-7,  4.740e-7,  5.110e-7,  5.530e-7,
        6.020e-7,  7.550e-7,  9.260e-7,  1.120e-6,  1.330e-6,  1.620e-6,
    }};

void check(const SnowParameters& snow) {
  for (const SnowParameterRange& range : snow_ranges) {
    const double value = snow.*range.value;
    if (value >= range.low && value <= range.high) continue;
    if (range.value == &SnowParameters::thickness && std::isinf(value) && value > 0.0) continue;
    PlainTextStream message;
    message << "snow: " << range.name << " must lie in [" << range.low << ", " << range.high
            << "], but is " << value;
    throw InvalidInput(message.str());
  }
}

/// Adds the spheres of a powder in air to a medium.
void add_powder(Medium& medium, std::string_view name, double volume_fraction, double wavelength) {
  if (volume_fraction == 0.0) return;
  const Pigment& powder = *std::ranges::find(pigments(), name, &Pigment::name);
  const MieBulk bulk = mie_bulk({.volume_fraction = volume_fraction,
                                 .median_radius = powder.median_radius,
                                 .sigma_log_radius = powder.sigma_log_radius,
                                 .ior = powder.ior(wavelength)},
                                medium.ior, wavelength);
  const double sigma_s = medium.sigma_s + bulk.sigma_s;
  medium.g = (medium.sigma_s * medium.g + bulk.sigma_s * bulk.g) / sigma_s;
  medium.sigma_s = sigma_s;
  medium.sigma_a += bulk.sigma_a;
}

}  // namespace

std::span<const SnowParameterRange> snow_parameter_ranges() { return snow_ranges; }

double ice_absorption_index(double wavelength) { return interpolate(ice_k, wavelength); }

LayerStack snow_layer_stack(const SnowParameters& snow, double wavelength) {
  check(snow);
  constexpr double mm_per_nm = 1e-6, millionth = 1e-6;
  const double ice = snow.density / ice_density;
  const double absorption =
      4.0 * std::numbers::pi * ice_absorption_index(wavelength) / (wavelength * mm_per_nm);
  // [KokhanovskyZege2004]: extinction and absorption of grains that absorb little.
  Medium medium{.sigma_a = path_lengthening * ice * absorption, .g = ice_g, .ior = 1.0};
  medium.sigma_s = 1.5 * ice / snow.grain_radius - medium.sigma_a;
  add_powder(medium, "carbon_black", snow.soot * millionth * snow.density / soot_density,
             wavelength);
  add_powder(medium, "mineral_dust", snow.dust * millionth * snow.density / dust_density,
             wavelength);
  return LayerStack({{.medium = medium, .thickness = snow.thickness}});
}

}  // namespace lamina
