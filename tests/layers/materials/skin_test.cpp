// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/layers/materials/skin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

// Isosbestic points of the table [Prahl1998]: both kinds absorb alike.
TEST(Hemoglobin, OxygenMakesNoDifferenceAtTheIsosbesticPoints) {
  for (const double nm : {500.0, 529.0, 545.0, 570.0, 584.0, 797.0}) {
    const double oxy = oxyhemoglobin_absorption(nm), deoxy = deoxyhemoglobin_absorption(nm);
    EXPECT_NEAR(oxy / deoxy, 1.0, 0.04) << nm << " nm";
  }
}

// [Bosschaart2014] measured 27.3/mm at 542 nm in oxygenated whole blood, within 4 %.
TEST(Hemoglobin, WholeBloodAbsorbsAsMeasuredIndependently) {
  EXPECT_NEAR(oxyhemoglobin_absorption(542.0), 27.3, 0.05 * 27.3);
}

// 139 500 L/(mol cm) at 451 nm in 1 g/L: the maximum of beta-carotene [Du1998].
TEST(Carotene, PeaksInTheBlueAndIsClearInTheRed) {
  EXPECT_NEAR(carotene_absorption(450.0), 59.9, 0.02 * 59.9);
  EXPECT_EQ(carotene_absorption(560.0), 0.0);
  EXPECT_EQ(carotene_absorption(650.0), 0.0);
}

// Jacques' own spectral library gives 679.16/cm at 500 nm.
TEST(Melanin, EumelaninIsTheMelanosomeOfJacques) {
  EXPECT_NEAR(eumelanin_absorption(500.0), 67.916, 0.01);
  EXPECT_GT(pheomelanin_absorption(400.0) / pheomelanin_absorption(700.0),
            eumelanin_absorption(400.0) / eumelanin_absorption(700.0));
}

TEST(SkinTables, EqualTheirSourceWhereItIsAtHand) {
  const std::filesystem::path file =
      std::filesystem::path(LAMINA_SHARED_DATA) / "chromophores/hemoglobin_prahl.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "reference data are absent: " << file;
  std::ifstream stream(file);
  const double per_extinction = std::log(10.0) * 150.0 / 64500.0 / 10.0;
  int rows = 0;
  for (std::string line; std::getline(stream, line);) {
    double nm = 0.0, oxy = 0.0, deoxy = 0.0;
    char comma = 0;
    std::istringstream row(line);
    if (!(row >> nm >> comma >> oxy >> comma >> deoxy) || nm < 350.0) continue;
    ++rows;
    EXPECT_NEAR(oxyhemoglobin_absorption(nm) / (per_extinction * oxy), 1.0, 1e-5) << nm;
    EXPECT_NEAR(deoxyhemoglobin_absorption(nm) / (per_extinction * deoxy), 1.0, 1e-5) << nm;
  }
  EXPECT_EQ(rows, 326);
}

TEST(Skin, WithoutPigmentAndBloodIsBaselineAlone) {
  const SkinParameters bare{.melanin = 0.0,
                            .hemoglobin_epidermis = 0.0,
                            .hemoglobin_dermis = 0.0,
                            .carotene = 0.0,
                            .baseline_scale = 1.0};
  for (const double nm : {400.0, 550.0, 700.0}) {
    EXPECT_DOUBLE_EQ(epidermis_absorption(bare, nm), baseline_absorption(nm));
    EXPECT_DOUBLE_EQ(dermis_absorption(bare, nm), baseline_absorption(nm));
  }
}

TEST(Skin, HasTheReducedScatteringOfEquation12AndHalfOfItInTheDermis) {
  const SkinParameters skin = with_constants({}, SkinConstants::paper);
  // 14.74 * 500^-0.22 + 2.2e11 / 500^4
  EXPECT_NEAR(epidermis_scattering(skin, 500.0), 3.755 + 3.52, 0.01);
  const LayerStack stack = skin_layer_stack(skin, 500.0);
  EXPECT_NEAR(sigma_s_prime(stack.layers()[0].medium), epidermis_scattering(skin, 500.0), 1e-12);
  EXPECT_NEAR(sigma_s_prime(stack.layers()[2].medium), 0.5 * epidermis_scattering(skin, 500.0),
              1e-12);
}

TEST(Skin, RefusesFractionsOutsideTheirRange) {
  try {
    (void)skin_layer_stack({.melanin = 0.7}, 500.0);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "skin: melanin must lie in [0, 0.5], but is 0.7");
  }
  EXPECT_THROW((void)skin_layer_stack({.carotene = std::nan("")}, 500.0), InvalidInput);
}

}  // namespace
}  // namespace lamina
