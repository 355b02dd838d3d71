// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/subsurface_color.h"

#include <gtest/gtest.h>

#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// What a half-space returns, by the solver of slabs.
SlabTotals solved(const HalfSpaceLook& look, double albedo, bool is_diffuse) {
  const LayerStack stack({{.medium = medium_of(look, albedo, 1.0), .top = look.top}});
  return adding_doubling(stack, {.is_diffuse = is_diffuse}).totals;
}

TEST(SubsurfaceColor, OfOpenPbrIsWhatLeavesOverWhatGetsInAlongTheNormal) {
  for (const double ior : {1.0, 1.4, 1.5})
    for (const double g : {0.0, 0.6})
      for (const double color : {0.05, 0.347, 0.485, 0.799}) {
        const HalfSpaceLook look{.ior = ior, .g = g};
        const auto totals =
            solved(look, subsurface_albedo(SubsurfaceColor::openpbr, color, look), false);
        EXPECT_NEAR(totals.diffuse_reflectance / (1.0 - totals.specular_reflectance), color,
                    1e-3 * color)
            << ior << " " << g;
      }
}

TEST(SubsurfaceColor, OfStandardSurfaceIsThatShareOfWhatTheSurfacePasses) {
  for (const double ior : {1.0, 1.4, 1.5})
    for (const double color : {0.05, 0.5, 0.9}) {
      const HalfSpaceLook look{.ior = ior, .g = 0.3};
      const auto totals =
          solved(look, subsurface_albedo(SubsurfaceColor::standard_surface, color, look), true);
      EXPECT_NEAR(totals.diffuse_reflectance / (1.0 - fresnel_diffuse(ior)), color, 1e-3 * color);
    }
}

TEST(SubsurfaceColor, OfEveryFormatComesBackFromItsAlbedo) {
  for (const SubsurfaceColor whose :
       {SubsurfaceColor::openpbr, SubsurfaceColor::standard_surface, SubsurfaceColor::khr_scatter})
    for (const double color : {0.0, 0.01, 0.5, 0.99})
      for (const double roughness : {0.0, 0.3}) {
        const HalfSpaceLook look{.ior = 1.4, .g = 0.2, .top = {.roughness = roughness}};
        EXPECT_NEAR(subsurface_color(whose, subsurface_albedo(whose, color, look), look), color,
                    5e-5);
      }
}

TEST(SubsurfaceColor, OfAnIndexBeyondTheTableIsThatOfTheNearest) {
  EXPECT_EQ(subsurface_albedo(SubsurfaceColor::openpbr, 0.5, {.ior = 2.4, .g = 0.97}),
            subsurface_albedo(SubsurfaceColor::openpbr, 0.5,
                              {.ior = highest_look_ior, .g = highest_look_g}));
}

}  // namespace
}  // namespace lamina
