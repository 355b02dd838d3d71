// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/renderer_albedos.h"

#include <gtest/gtest.h>

#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace lamina {
namespace {

TEST(VanDeHulst, AlbedoOfTheColorIsTheAlbedo) {
  for (const double g : {-0.5, 0.0, 0.8})
    for (const double albedo : {0.01, 0.3, 0.9, 0.9999})
      EXPECT_NEAR(van_de_hulst_albedo(van_de_hulst_color(albedo, g), g), albedo, 3e-5);
}

TEST(VanDeHulst, ColorIsThatOfRadiativeTransferWithinThreePercentForIsotropicScattering) {
  const HalfSpaceColor solved({.ior = 1.0, .g = 0.0, .definition = ColorDefinition::diffuse});
  for (const double albedo : {0.1, 0.5, 0.9, 0.99, 0.999})
    EXPECT_NEAR(van_de_hulst_color(albedo, 0.0) / solved.color(albedo), 1.0, 0.03) << albedo;
}

TEST(Wrenninge, ColorIsThatOfRadiativeTransferWhereTheFitIsGood) {
  const HalfSpaceColor solved({.ior = 1.0, .g = 0.0, .definition = ColorDefinition::diffuse});
  for (const double color : {0.1, 0.3, 0.6})  // docs/albedo_inversion.md: within 7 %
    EXPECT_NEAR(solved.color(wrenninge_albedo(color, 0.0)) / color, 1.0, 0.03) << color;
  EXPECT_EQ(wrenninge_albedo(1.0, 0.0), 0.999999);
}

TEST(VanDeHulst, HasBlackAndWhiteAtTheEnds) {
  EXPECT_EQ(van_de_hulst_color(0.0, 0.8), 0.0);
  EXPECT_EQ(van_de_hulst_color(1.0, 0.8), 1.0);
}

}  // namespace
}  // namespace lamina
