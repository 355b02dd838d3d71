// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Paint by its pigments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/pigments.h"
#include "lamina/layers/optics/mie.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

Material paint(const std::string& recipe, const std::string& more = "") {
  return parse_material(R"({"lamina": "material", "version": 1, "length_unit": "um", )" + more +
                            "\"paint\": {" + recipe + "}}",
                        "f");
}

std::vector<double> reflectances(const Material& material) {
  std::vector<double> all;
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    all.push_back(adding_doubling(layer_stack(material, band), {}, {.accuracy = 1e-4})
                      .totals.diffuse_reflectance);
  return all;
}

Lab color(const Material& material) {
  return lab(linear_srgb(make_band_weights(material.bands), reflectances(material)));
}

// Handbooks of minerals give rutile n_o = 2.616 and n_e = 2.903 at 589 nm.
TEST(Pigments, RutileHasItsIndexAtTheSodiumLine) {
  EXPECT_NEAR(rutile_ior(589.3).real(), (2.0 * 2.616 + 2.903) / 3.0, 0.005);
  EXPECT_EQ(rutile_ior(589.3).imag(), 0.0);
  EXPECT_GT(rutile_ior(450.0).real(), rutile_ior(650.0).real());
}

TEST(Pigments, HematiteAbsorbsBlueAndPassesRed) {
  EXPECT_EQ(hematite_ior(400.0), std::complex(2.756, 1.294));  // a row of its source
  EXPECT_EQ(hematite_ior(650.0), std::complex(3.074, 0.057));
  EXPECT_NEAR(hematite_ior(555.0).imag(), 0.5 * (0.498 + 0.437), 1e-12);
}

// White pigment is ground to a diameter of 0.2 to 0.3 µm, because it hides best there.
TEST(Pigments, RutileScattersMostAtTheSizeThatPaintMakersUse) {
  double best = 0.0, best_radius = 0.0;
  for (double radius = 0.03e-3; radius < 0.5e-3; radius *= 1.05) {
    const MieBulk bulk = mie_bulk(
        {.volume_fraction = 0.1, .median_radius = radius, .ior = rutile_ior(550.0)}, 1.5, 550.0);
    if (bulk.sigma_s * (1.0 - bulk.g) < best) continue;
    best = bulk.sigma_s * (1.0 - bulk.g);
    best_radius = radius;
  }
  EXPECT_GT(best_radius, 0.08e-3);
  EXPECT_LT(best_radius, 0.15e-3);
}

TEST(Paint, IsTheSumOfItsPigments) {
  const Material both = paint(
      R"("thickness": 50, "binder_ior": 1.48, "pigments": [
           { "pigment": "titanium_dioxide", "fraction": 0.1 },
           { "name": "beads", "ior": 1.59, "k": 0.001, "median_radius": 0.5, "fraction": 0.05 } ])",
      R"("bands": [450, 550], "ior_below": 1.5, )");
  ASSERT_EQ(both.layers.size(), 1U);
  EXPECT_DOUBLE_EQ(both.layers[0].thickness, 0.05);
  for (std::size_t band = 0; band < 2; ++band) {
    const double nm = both.bands.wavelengths()[band];
    const MieBulk white = mie_bulk({.volume_fraction = 0.1,
                                    .median_radius = 1e-4,
                                    .sigma_log_radius = 0.3,
                                    .ior = rutile_ior(nm)},
                                   1.48, nm);
    const MieBulk beads =
        mie_bulk({.volume_fraction = 0.05, .median_radius = 5e-4, .ior = {1.59, 0.001}}, 1.48, nm);
    const Medium medium = layer_stack(both, band).layers()[0].medium;
    const double sigma_s = white.sigma_s + beads.sigma_s;
    EXPECT_NEAR(medium.sigma_s, sigma_s, 1e-9 * sigma_s);
    EXPECT_NEAR(medium.sigma_a, beads.sigma_a, 1e-9 * beads.sigma_a);
    EXPECT_NEAR(medium.g, (white.sigma_s * white.g + beads.sigma_s * beads.g) / sigma_s, 1e-9);
  }
}

TEST(Paint, ThickerCoatHidesBlackBetter) {
  double before = 0.0;
  for (const char* thickness : {"5", "15", "50", "\"infinite\""}) {
    const std::string recipe =
        std::string(R"("pigments": [{ "pigment": "titanium_dioxide", "fraction": 0.1 }], )") +
        "\"thickness\": " + thickness;
    const bool is_finite = thickness[0] != '"';
    const double now =
        reflectances(paint(recipe, std::string(R"("bands": [550], )") +
                                       (is_finite ? R"("ior_below": 1.5, )" : "")))[0];
    EXPECT_GT(now, before) << thickness;
    before = now;
  }
  EXPECT_NEAR(before, 0.96, 1e-3);  // nothing absorbs: all that enters comes back
}

TEST(Paint, PigmentsGiveTheirColor) {
  const Lab white = color(find_material("white_paint")), red = color(find_material("red_paint")),
            gray = color(find_material("gray_paint"));
  EXPECT_GT(white.lightness, 93.0);
  EXPECT_LT(std::hypot(white.a, white.b), 4.0);
  EXPECT_GT(red.a, 20.0);
  EXPECT_GT(red.b, 10.0);
  EXPECT_LT(red.lightness, 50.0);
  EXPECT_LT(gray.lightness, white.lightness - 15.0);
  EXPECT_GT(gray.lightness, 30.0);
  EXPECT_LT(std::hypot(gray.a, gray.b), 8.0);
}

}  // namespace
}  // namespace lamina
