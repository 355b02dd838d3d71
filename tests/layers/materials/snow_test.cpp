// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Snow by its grains.
#include "lamina/layers/materials/snow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/optics/mie.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

Medium medium(const SnowParameters& snow, double wavelength) {
  return snow_layer_stack(snow, wavelength).layers()[0].medium;
}

/// What deep or finite snow reflects of light that comes evenly from above.
double albedo_of(const SnowParameters& snow, double wavelength) {
  return adding_doubling(snow_layer_stack(snow, wavelength), {.is_diffuse = true},
                         {.accuracy = 1e-5})
      .totals.diffuse_reflectance;
}

TEST(Snow, IceAbsorbsAsItsSourceSays) {
  EXPECT_EQ(ice_absorption_index(400.0), 2.365e-11);  // rows of [WarrenBrandt2008]
  EXPECT_EQ(ice_absorption_index(500.0), 5.889e-10);
  EXPECT_EQ(ice_absorption_index(600.0), 5.730e-9);
  EXPECT_EQ(ice_absorption_index(700.0), 2.900e-8);
  EXPECT_EQ(ice_absorption_index(1000.0), 1.620e-6);
  EXPECT_NEAR(ice_absorption_index(555.0), 0.5 * (2.289e-9 + 2.839e-9), 1e-20);
}

// Extinction is that of large spheres by Mie. What spheres have for the two numbers of shape is in
// the literature (1.25 and .89 [KokhanovskyZege2004]); real grains lengthen paths more and scatter
// less far forward, as the header says, but not by much.
TEST(Snow, GrainsAreCloseToSpheresByMie) {
  const double wavelength = 700.0, radius = 0.1, fraction = 200.0 / 917.0;
  const double alpha = 4.0 * std::numbers::pi * 2.9e-8 / (wavelength * 1e-6);
  const MieBulk spheres =
      mie_bulk({.volume_fraction = fraction,
                .median_radius = radius * std::exp(-2.5 * 0.1 * 0.1),  // of area per volume
                .sigma_log_radius = 0.1,
                .ior = {1.3069, 2.9e-8}},
               1.0, wavelength);
  const Medium snow = medium({.grain_radius = radius, .density = 200.0}, wavelength);
  EXPECT_NEAR(sigma_t(snow), spheres.sigma_s + spheres.sigma_a, 0.02 * sigma_t(snow));
  EXPECT_NEAR(spheres.sigma_a / (alpha * fraction), 1.25, 0.06);
  EXPECT_NEAR(spheres.g, 0.89, 0.005);
  EXPECT_NEAR(snow.sigma_a / (alpha * fraction), 1.6, 1e-3);
  EXPECT_NEAR(snow.g, 0.82, 1e-12);
}

// exp(-4 s), s² = (1 - albedo) / (3 (1 - g)): the asymptotic theory of weak absorption
// [KokhanovskyZege2004], which knows nothing of phase functions and boundaries.
TEST(Snow, AlbedoIsThatOfTheAsymptoticTheory) {
  for (const double radius : {0.05, 0.1, 0.5, 1.0})
    for (const double wavelength : {450.0, 550.0, 650.0, 750.0}) {
      const SnowParameters snow{.grain_radius = radius};
      const Medium m = medium(snow, wavelength);
      const double y = 4.0 * std::sqrt((1.0 - albedo(m)) / (3.0 * (1.0 - m.g)));
      EXPECT_NEAR(albedo_of(snow, wavelength), std::exp(-y), 0.15 * y * y + 2e-4)
          << radius << " mm, " << wavelength << " nm";
    }
}

// [WiscombeWarren1980], [WarrenWiscombe1980]: pure snow has 96 to 99 % in the visible, less with
// larger grains, the same with any density; a millionth of soot or less takes 5 to 15 %.
TEST(Snow, IsAsWhiteAsTheLiteratureSays) {
  for (const double wavelength : {400.0, 500.0, 600.0})
    for (const double radius : {0.05, 0.2, 1.0}) {
      const double white = albedo_of({.grain_radius = radius}, wavelength);
      EXPECT_GT(white, 0.93);
      EXPECT_LT(white, 0.9995);
      EXPECT_NEAR(albedo_of({.grain_radius = radius, .density = 450.0}, wavelength), white, 2e-5);
      EXPECT_LT(albedo_of({.grain_radius = 1.5 * radius}, wavelength), white);
    }
  EXPECT_NEAR(albedo_of({.grain_radius = 0.1}, 500.0), 0.99, 0.005);
  const double clean = albedo_of({.grain_radius = 0.2}, 500.0);
  const double sooty = albedo_of({.grain_radius = 0.2, .soot = 0.5}, 500.0);
  EXPECT_GT(clean - sooty, 0.05);
  EXPECT_LT(clean - sooty, 0.15);
}

TEST(Snow, DustColorsIt) {
  const SnowParameters dusty{.grain_radius = 0.3, .dust = 500.0};
  EXPECT_LT(albedo_of(dusty, 450.0), albedo_of(dusty, 550.0));
  EXPECT_GT(albedo_of({.grain_radius = 0.3}, 450.0), albedo_of({.grain_radius = 0.3}, 550.0));
}

// Light that passes half a meter of snow is blue, as in a hole of a ski pole.
TEST(Snow, IsBlueInDepth) {
  const auto passed = [](double wavelength) {
    return adding_doubling(snow_layer_stack({.thickness = 500.0}, wavelength), {.is_diffuse = true},
                           {.accuracy = 1e-6})
        .totals.transmittance;
  };
  EXPECT_GT(passed(470.0), 1.5 * passed(540.0));
  EXPECT_GT(passed(540.0), 3.0 * passed(645.0));
}

TEST(Snow, BuiltinsAreWhiteAndGray) {
  const auto color = [](const char* name) {
    const Material material = find_material(name);
    std::vector<double> spectrum;
    for (const LayerStack& stack : layer_stacks(material))
      spectrum.push_back(adding_doubling(stack).totals.diffuse_reflectance);
    return lab(linear_srgb(make_band_weights(material.bands), spectrum));
  };
  const Lab fresh = color("snow"), old = color("old_snow");
  EXPECT_GT(fresh.lightness, 98.0);
  EXPECT_LT(fresh.b, 0.0);  // bluish
  EXPECT_GT(fresh.b, -3.0);
  EXPECT_LT(old.lightness, 93.0);
  EXPECT_GT(old.lightness, 80.0);
  EXPECT_GT(old.b, 0.0);  // yellowish
}

TEST(Snow, RefusesWhatCannotBe) {
  const auto message = [](const SnowParameters& snow) {
    try {
      (void)snow_layer_stack(snow, 550.0);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({.density = -1.0}), "snow: density must lie in [10, 700], but is -1");
  EXPECT_EQ(message({.grain_radius = 10.0}), "snow: grain_radius must lie in [0.02, 5], but is 10");
  EXPECT_EQ(message({.soot = std::nan("")}), "snow: soot must lie in [0, 1000], but is nan");
  EXPECT_EQ(message({.thickness = -INFINITY}),
            "snow: thickness must lie in [0.1, 1e+06], but is -inf");
  EXPECT_EQ(message({}), "");
}

}  // namespace
}  // namespace lamina
