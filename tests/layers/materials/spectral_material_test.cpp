// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Coefficients over wavelengths in material files.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/materials/chromophores.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/materials/skin.h"

namespace lamina {
namespace {

const std::filesystem::path folder =
    std::filesystem::path(LAMINA_SOURCE_DIR) / "tests/inputs/material/good";

TEST(SpectralMaterial, TakesTablesLawsAndChromophores) {
  const Material material = load_material(folder / "spectra.json");
  const MaterialLayer &dyed = material.layers[0], &tissue = material.layers[1];
  // dye.csv holds 4, 6 and 5 per cm at 450, 500 and 600 nm; half of it is here.
  EXPECT_DOUBLE_EQ(dyed.sigma_a[0], 0.2);
  EXPECT_DOUBLE_EQ(dyed.sigma_a[1], 0.3);
  EXPECT_DOUBLE_EQ(dyed.sigma_a[2], 0.25);
  EXPECT_DOUBLE_EQ(dyed.ior[0], 1.345);
  EXPECT_DOUBLE_EQ(dyed.sigma_s[1], 2.0 / 0.25);  // 20 per cm, reduced
  EXPECT_DOUBLE_EQ(dyed.sigma_s[2], 8.0 * std::pow(1.2, -1.5));
  EXPECT_DOUBLE_EQ(tissue.sigma_a[1], 0.02 * oxyhemoglobin_absorption(500.0) + 0.006 + 0.03);
  EXPECT_DOUBLE_EQ(tissue.sigma_s[1], 20.0);
  EXPECT_DOUBLE_EQ(tissue.sigma_s[0],
                   20.0 * (0.25 * std::pow(0.9, -4.0) + 0.75 * std::pow(0.9, -0.7)));
  EXPECT_DOUBLE_EQ(tissue.mixture[0].sigma_s[1], 2.0);
}

TEST(SpectralMaterial, TakesOtherBands) {
  const std::vector<double> red = {700.0};
  const Material material = find_sampled_material((folder / "spectra.json").string(), red);
  ASSERT_EQ(material.bands.size(), 1U);
  EXPECT_DOUBLE_EQ(material.layers[0].sigma_a[0], 0.2);
  const Material skin = find_sampled_material("skin_type_2", red);
  EXPECT_EQ(skin.layers[0].sigma_a, (std::vector{epidermis_absorption(skin.skin->skin, 700.0)}));
}

TEST(SpectralMaterial, ArraysOfTheirOwnBandsAreNotTakenForOthers) {
  const std::vector<double> three = {450.0, 550.0, 650.0};  // as many as jade has numbers
  try {
    (void)find_sampled_material("jade", three);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("cannot be had at other wavelengths"),
              std::string::npos)
        << error.what();
  }
}

TEST(SpectralMaterial, RecipesTakeTables) {
  const Material skin = load_material(folder / "skin_ink_table.json");
  // ink.csv goes from 0.5 at 300 nm to 1 at 400, 0.2 at 600, 0.8 at 1200 nm.
  const std::vector<std::array<double, 2>> expected = {
      {350.0, 0.75}, {400.0, 1.0}, {600.0, 0.2}, {1000.0, 0.6}};
  const SkinParameters& parameters = skin.skin->skin;
  for (const auto& points : {parameters.junction_spectrum, parameters.inks[0].spectrum}) {
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(points[i][0], expected[i][0]);
      EXPECT_NEAR(points[i][1], expected[i][1], 1e-15);
    }
  }
  EXPECT_NEAR(junction_absorbance(parameters, 500.0), 3.0 * 0.6, 1e-14);
  const Material paint = load_material(folder / "paint_table.json");
  const Material same = parse_material(R"({"lamina": "material", "version": 1, "length_unit": "um",
      "bands": [450, 600], "ior_below": 1.5, "paint": {"binder_ior": [1.345, 1.335], "thickness": 50,
      "pigments": [{"ior": 1.9, "k": [0.2, 0.2], "median_radius": 0.2, "fraction": 0.05}]}})",
                                       "same");
  for (std::size_t band = 0; band < 2; ++band) {
    const MixturePart &a = paint.layers[0].mixture[0], &b = same.layers[0].mixture[0];
    EXPECT_NEAR(a.sigma_a[band], b.sigma_a[band], 1e-9 * b.sigma_a[band]);
    EXPECT_NEAR(a.sigma_s[band], b.sigma_s[band], 1e-9 * b.sigma_s[band]);
    EXPECT_NEAR(paint.layers[0].ior[band], same.layers[0].ior[band], 1e-14);
  }
}

TEST(SpectralMaterial, TheExampleIsRead) {
  const std::vector<double> wavelengths = {550.0, 565.0, 700.0};
  const Material material = find_sampled_material(
      LAMINA_SOURCE_DIR "/examples/spectra/phantom_on_tissue.json", wavelengths);
  EXPECT_DOUBLE_EQ(material.layers[0].sigma_a[0], 0.118);
  EXPECT_DOUBLE_EQ(material.layers[0].sigma_a[1], 0.1245);
  EXPECT_DOUBLE_EQ(material.layers[0].sigma_s[2], 1.18 / 0.3);
}

// Skin of [Jacques2013], Table 1, number 6: both laws are fits to the same measured curve, and
// within 12 % of each other from 450 to 1100 nm.
TEST(SpectralMaterial, BothLawsOfMeasuredSkinAgree) {
  const Material material = parse_material(R"({"lamina": "material", "version": 1,
      "length_unit": "cm", "bands": [450, 500, 600, 700, 900, 1100], "ior_below": 1, "layers": [
      {"sigma_a": 0, "sigma_s_prime": {"a": 45.3, "b": 1.292}, "g": 0, "ior": 1.4, "thickness": 1},
      {"sigma_a": 0, "sigma_s_prime": {"a": 43.6, "b": 0.562, "rayleigh_fraction": 0.41}, "g": 0,
       "ior": 1.4, "thickness": 1}]})",
                                           "skin");
  for (std::size_t band = 0; band < material.bands.size(); ++band)
    EXPECT_NEAR(material.layers[1].sigma_s[band] / material.layers[0].sigma_s[band], 1.0, 0.12);
}

// Values of well-known spectra: peaks of blood of 150 g/L [Prahl1998], melanosomes [Jacques1998],
// pure water.
TEST(SpectralMaterial, KnowsChromophores) {
  const auto at = [](const std::string& name, double nm) {
    for (const Chromophore& one : chromophores())
      if (one.name == name) return one.absorption(nm);
    return std::nan("");
  };
  EXPECT_NEAR(at("oxyhemoglobin", 542.0), 28.5, 0.1);
  EXPECT_NEAR(at("deoxyhemoglobin", 556.0), 29.2, 0.1);
  EXPECT_NEAR(at("eumelanin", 500.0), 67.9, 0.1);
  EXPECT_NEAR(at("water", 750.0), 0.0026, 0.0003);  // [HaleQuerry1973]: 0.026 per cm
}

}  // namespace
}  // namespace lamina
