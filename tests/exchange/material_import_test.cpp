// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/material_import.h"

#include <gtest/gtest.h>

#include <limits>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

double returned(const Material& material, std::size_t band) {
  return adding_doubling(layer_stack(material, band), {.is_diffuse = true})
      .totals.diffuse_reflectance;
}

TEST(MaterialImport, OpenPbrIsItsMedium) {
  const ImportedMaterial imported = import_material({.color = {0.5, 0.5, 0.5},
                                                     .radius = {2.0, 1.0, 0.5},
                                                     .scale = 0.5,
                                                     .g = 0.3,
                                                     .mm_per_unit = 10.0});
  const MaterialLayer& layer = imported.material.layers.front();
  for (std::size_t c = 0; c < 3; ++c) {
    const double radius[] = {10.0, 5.0, 2.5};
    EXPECT_NEAR(1.0 / (layer.sigma_a[c] + layer.sigma_s[c]), radius[c], 1e-12 * radius[c]);
    EXPECT_EQ(layer.g[c], 0.3);
  }
  EXPECT_EQ(layer.top.roughness, 0.3 * 0.3);
}

TEST(MaterialImport, OpenPbrShowsItsColorByTheDefinition) {
  const std::array<double, 3> color = {0.799, 0.485, 0.347};
  const ImportedMaterial imported = import_material({.color = color, .ior = 1.4, .roughness = 0.0});
  for (std::size_t c = 0; c < 3; ++c) {
    const auto totals = adding_doubling(layer_stack(imported.material, c), {}).totals;
    EXPECT_NEAR(totals.diffuse_reflectance / (1.0 - totals.specular_reflectance), color[c], 1e-3);
  }
  EXPECT_NE(imported.definition.find("OpenPBR 1.1.1"), std::string::npos);
}

TEST(MaterialImport, ArnoldsColorComesOutBelowTheSurface) {
  const ImportedMaterial imported = import_material(
      {.source = ImportSource::arnold, .color = {0.8, 0.4, 0.1}, .ior = 1.4, .roughness = 0.0});
  const double enters = 1.0 - fresnel_diffuse(1.4), wanted[] = {0.8, 0.4, 0.1};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(returned(imported.material, c), enters * wanted[c], 1e-3 * wanted[c]);
    EXPECT_LT(imported.misfits[c].reflectance.spread->profile_rms, 0.3);
  }
}

TEST(MaterialImport, PrincipledOfThreeVersionsHasTheLengthsThatEachMeans) {
  ImportedParameters p{.source = ImportSource::principled,
                       .color = {0.6, 0.6, 0.6},
                       .g = 0.5,
                       .ior = 1.0,
                       .roughness = 0.0};
  const double four_pi = 12.566370614359172;
  for (const auto& [rules, factor] : {std::pair{BlenderRules::blender_3, 0.5 / four_pi},
                                      std::pair{BlenderRules::blender_4, 0.5 / four_pi},
                                      std::pair{BlenderRules::blender_5_2, 1.0}}) {
    p.blender = rules;
    const ImportedMaterial imported = import_material(p);
    const MaterialLayer& layer = imported.material.layers.front();
    EXPECT_NEAR(1.0 / (layer.sigma_a[0] + layer.sigma_s[0]), factor, 1e-9);
    // Below a surface that does nothing the color is nearly the one that was asked for.
    EXPECT_NEAR(returned(imported.material, 0), 0.6, 0.04);
  }
}

TEST(MaterialImport, WhatCannotBeIsRefusedByName) {
  const auto message = [](const ImportedParameters& p) {
    try {
      (void)import_material(p);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  EXPECT_EQ(message({.color = {0.5, 1.5, 0.5}}), "color G must lie in [0, 1], but is 1.5");
  EXPECT_NE(message({.radius = {1.0, 1.0, 0.0}}).find("radius B"), std::string::npos);
  EXPECT_NE(message({.radius = {1.0, 1.0, 0.0}}).find("matte"), std::string::npos);
  EXPECT_NE(message({.g = 0.95}).find("g must lie"), std::string::npos);
  EXPECT_NE(message({.ior = std::numeric_limits<double>::quiet_NaN()}).find("ior"),
            std::string::npos);
}

}  // namespace
}  // namespace lamina
