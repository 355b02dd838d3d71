// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Prints the coefficients of the built-in materials sand, white_sand and varnish, per band and mm,
// from the measurements that their files cite. Takes no arguments; about a second.
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/pigments.h"
#include "lamina/layers/optics/mie.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace {

using namespace lamina;

constexpr std::array<double, 8> wavelengths = {400, 435, 470, 505, 540, 575, 610, 645};

/// The argument in (1e-9, highest) at which a function that never rises takes a value.
double inverse_of_falling(const std::function<double(double)>& function, double value,
                          double highest) {
  double low = std::log(1e-9), high = std::log(highest);
  while (high - low > 1e-7) {
    const double middle = 0.5 * (low + high);
    (function(std::exp(middle)) > value ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

double diffuse_reflectance(const LayerStack& stack) {
  return adding_doubling(stack, {}, {.accuracy = 1e-6}).totals.diffuse_reflectance;
}

struct Sand {
  const char* name;
  double ior, grain_radius;  ///< [mm]
  std::array<double, 8> reflectance;
};

// [Baldridge2009]: soils of Johns Hopkins University, directional hemispherical reflectance, rows
// at the eight wavelengths.
constexpr Sand sands[] = {
    // Quartzipsamment, 87P706.
    {"sand", 1.55, 0.15, {0.0106, 0.0454, 0.0667, 0.0957, 0.1307, 0.1621, 0.1818, 0.2013}},
    // Torripsamment, 0015: dunes of gypsum.
    {"white_sand", 1.52, 0.15, {0.4681, 0.5407, 0.6035, 0.6486, 0.6952, 0.7435, 0.7642, 0.7728}},
};

/// Grains that are packed at random: extinction as of snow's (layers/materials/snow.h), the mean
/// cosine of spheres, and the absorption that makes a deep bed reflect what was measured.
void print_sand(const Sand& sand) {
  constexpr double packing = 0.6;
  const double extinction = 1.5 * packing / sand.grain_radius;
  const double spheres_g = mie_bulk({.volume_fraction = packing,
                                     .median_radius = sand.grain_radius,
                                     .sigma_log_radius = 0.2,
                                     .ior = sand.ior},
                                    1.0, 550.0)
                               .g;
  const double g = 1e-3 * std::round(1e3 * spheres_g);  // as the file has it
  std::printf("%s: sigma_t %.4g, g %.3f, sigma_a", sand.name, extinction, g);
  for (const double reflectance : sand.reflectance) {
    const auto reflected = [&](double sigma_a) {
      const Medium medium{.sigma_a = sigma_a, .sigma_s = extinction - sigma_a, .g = g, .ior = 1.0};
      return diffuse_reflectance(LayerStack({{.medium = medium}}));
    };
    std::printf(" %.4g", inverse_of_falling(reflected, reflectance, extinction));
  }
  std::printf("\n");
}

/// ASTM E313 under D65 for the observer of 1931.
double yellowness_index(const std::vector<double>& spectrum) {
  const BandSet bands({wavelengths.begin(), wavelengths.end()});
  const auto [x, y, z] = linear_srgb_to_xyz() * linear_srgb(make_band_weights(bands), spectrum);
  return 100.0 * (1.2985 * x - 1.1335 * z) / y;
}

/// Aged acrylic medium on acrylic gesso: the index of PMMA [Sultanova2009] in both, rutile in the
/// lower one, absorption exp(-0.014 / nm) as of oxidized organic matter [Bricaud1981], and as much
/// of it as makes the gesso as yellow as measured by [Whitmore2002].
void print_varnish() {
  constexpr double thickness = 0.05, slope = 0.014, measured_yellowness = 23.0;
  const Pigment& rutile = pigments().front();
  std::vector<Medium> gesso;
  for (const double wavelength : wavelengths) {
    const double square = wavelength * wavelength * 1e-6;  // of the wavelength in micrometres
    const double ior = std::sqrt(1.0 + 1.1819 * square / (square - 0.011313));
    const MieBulk bulk = mie_bulk({.volume_fraction = 0.1,
                                   .median_radius = rutile.median_radius,
                                   .sigma_log_radius = rutile.sigma_log_radius,
                                   .ior = rutile.ior(wavelength)},
                                  ior, wavelength);
    gesso.push_back({.sigma_s = bulk.sigma_s, .g = bulk.g, .ior = ior});
  }
  const auto absorption = [&](double at_400, std::size_t band) {
    return at_400 * std::exp(-slope * (wavelengths[band] - 400.0));
  };
  const auto whiteness = [&](double at_400) {
    std::vector<double> spectrum;
    for (std::size_t band = 0; band < gesso.size(); ++band) {
      const Medium film{.sigma_a = absorption(at_400, band), .ior = gesso[band].ior};
      spectrum.push_back(diffuse_reflectance(
          LayerStack({{.medium = film, .thickness = thickness}, {.medium = gesso[band]}})));
    }
    return -yellowness_index(spectrum);
  };
  const double at_400 = inverse_of_falling(whiteness, -measured_yellowness, 100.0);
  std::printf("varnish: sigma_a");
  for (std::size_t band = 0; band < gesso.size(); ++band)
    std::printf(" %.4g", absorption(at_400, band));
  std::printf("\n  gesso: ior");
  for (const Medium& medium : gesso) std::printf(" %.4f", medium.ior);
  std::printf(", sigma_s");
  for (const Medium& medium : gesso) std::printf(" %.4g", medium.sigma_s);
  std::printf(", g");
  for (const Medium& medium : gesso) std::printf(" %.4f", medium.g);
  std::printf("\n");
}

}  // namespace

int main() {
  for (const Sand& sand : sands) print_sand(sand);
  print_varnish();
}
