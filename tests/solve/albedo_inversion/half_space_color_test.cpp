// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/albedo_inversion/half_space_color.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/base/core/random.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "literal/h_function.h"

namespace lamina {
namespace {

constexpr std::array definitions = {ColorDefinition::openpbr, ColorDefinition::normal,
                                    ColorDefinition::diffuse, ColorDefinition::furnace};

HalfSpaceLook random_look(Random& random, bool is_rough) {
  HalfSpaceLook look{.ior = 1.0 + 0.6 * random.uniform(),
                     .g = -0.3 + 1.25 * random.uniform(),
                     .definition = definitions[static_cast<std::size_t>(4.0 * random.uniform())]};
  if (is_rough)
    look.top = {random.uniform(), random.uniform() < 0.5 ? MicrofacetDistribution::beckmann
                                                         : MicrofacetDistribution::ggx};
  return look;
}

/// How far the color of an inverted albedo is off, as a share of the color that is wanted.
double error_of(const HalfSpaceLook& look, double place) {
  const HalfSpaceColor half_space(look);
  const double low = std::max(0.01, half_space.darkest());
  const double high = std::min(0.99, half_space.brightest());
  const double wanted = low * std::pow(high / low, place);
  return std::abs(solve_color(look, half_space.albedo(wanted)).color / wanted - 1.0);
}

TEST(HalfSpaceColor, ComesOutOfASmoothSurfaceWithinATenthOfAPercent) {
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Random random = make_random(1, i);
    HalfSpaceLook look = random_look(random, false);
    if (i % 4 == 0) look.ior = 1.0 + 0.01 * random.uniform();
    worst = std::max(worst, error_of(look, random.uniform()));
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(worst, 0.0);
}

TEST(HalfSpaceColor, ComesOutOfARoughSurfaceWithinATenthOfAPercent) {
  for (std::uint64_t i = 0; i < 3; ++i) {
    Random random = make_random(2, i);
    const HalfSpaceLook look = random_look(random, true);
    EXPECT_LT(error_of(look, random.uniform()), 1e-3)
        << look.ior << " " << look.g << " " << look.top.roughness;
  }
  const HalfSpaceLook nearly_matched{
      1.0027, 0.84, {0.18, MicrofacetDistribution::ggx}, ColorDefinition::diffuse};
  EXPECT_LT(error_of(nearly_matched, 0.15), 1e-3);
}

TEST(HalfSpaceColor, OfEveryDefinitionIsBrightestWithoutAbsorptionAndDarkestWithoutScattering) {
  for (const ColorDefinition definition : definitions)
    for (const double ior : {1.0, 1.4, 1.6})
      for (const double roughness : {0.0, 0.4}) {
        const HalfSpaceColor half_space({ior, 0.7, {roughness}, definition});
        EXPECT_EQ(half_space.color(1.0), half_space.brightest());
        EXPECT_EQ(half_space.color(0.0), half_space.darkest());
        EXPECT_EQ(half_space.albedo(half_space.brightest()), 1.0);
        EXPECT_EQ(half_space.albedo(half_space.darkest()), 0.0);
        const bool is_whole =
            definition == ColorDefinition::openpbr || definition == ColorDefinition::furnace;
        if (is_whole || ior == 1.0) {
          EXPECT_EQ(half_space.brightest(), 1.0);
        }
        if (definition != ColorDefinition::furnace || ior == 1.0) {
          EXPECT_EQ(half_space.darkest(), 0.0);
        }
      }
}

TEST(HalfSpaceColor, LeavesOutOrTakesInWhatFresnelReflects) {
  EXPECT_NEAR(HalfSpaceColor({.ior = 1.5, .definition = ColorDefinition::normal}).brightest(),
              1.0 - 0.04, 1e-15);
  for (const double ior : {1.003, 1.05, 1.33, 1.5, 1.6}) {
    const double reflected = fresnel_diffuse(ior);
    EXPECT_NEAR(HalfSpaceColor({.ior = ior, .definition = ColorDefinition::diffuse}).brightest(),
                1.0 - reflected, 1e-15);
    EXPECT_NEAR(HalfSpaceColor({.ior = ior, .definition = ColorDefinition::furnace}).darkest(),
                reflected, 1e-15);
    // The table goes over from rough to smooth surfaces without a step.
    EXPECT_NEAR(HalfSpaceColor({ior, 0.0, {2e-4}, ColorDefinition::furnace}).darkest(), reflected,
                1e-5);
  }
}

TEST(HalfSpaceColor, GrowsWithTheAlbedoAndInvertsToIt) {
  for (const double ior : {1.0, 1.002, 1.3, 1.6})
    for (const double g : {-0.3, 0.0, 0.95})
      for (const double roughness : {0.0, 0.05, 1.0})
        for (const ColorDefinition definition : definitions) {
          const HalfSpaceColor half_space({ior, g, {roughness}, definition});
          double last = half_space.color(0.0);
          for (int i = 1; i <= 200; ++i) {
            const double s = 1.0 - i / 200.0;
            const double albedo = (1.0 - s * s) / (1.0 - g * s * s);
            const double color = half_space.color(albedo);
            EXPECT_GT(color, last) << ior << " " << g << " " << roughness << " " << albedo;
            EXPECT_NEAR(half_space.albedo(std::min(color, half_space.brightest())), albedo, 1e-9);
            last = color;
          }
        }
}

// Of a matched half-space that scatters isotropically 1 - sqrt(1 - W) H(mu) of a beam comes back
// [Chandrasekhar1960].
TEST(HalfSpaceColor, MatchedAndIsotropicIsChandrasekhars) {
  const Quadrature rule = gauss_legendre(16, 0.0, 1.0);
  for (const double albedo : {0.1, 0.5, 0.8, 0.95, 0.99}) {
    const auto plane_albedo = [&](double mu) {
      return 1.0 - std::sqrt(1.0 - albedo) * reference::h_function(albedo, mu);
    };
    const double normal = plane_albedo(1.0);
    double diffuse = 0.0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k)
      diffuse += 2.0 * rule.weights[k] * rule.nodes[k] * plane_albedo(rule.nodes[k]);
    const auto color = [&](ColorDefinition definition) {
      return HalfSpaceColor({.ior = 1.0, .definition = definition}).color(albedo);
    };
    EXPECT_NEAR(color(ColorDefinition::normal), normal, 3e-4 * normal) << albedo;
    EXPECT_NEAR(color(ColorDefinition::openpbr), normal, 3e-4 * normal) << albedo;
    EXPECT_NEAR(color(ColorDefinition::diffuse), diffuse, 3e-4 * diffuse) << albedo;
    EXPECT_NEAR(color(ColorDefinition::furnace), diffuse, 3e-4 * diffuse) << albedo;
  }
}

TEST(HalfSpaceColor, IsThatOfPhotons) {
  const HalfSpaceLook look{
      .ior = 1.4, .g = 0.8, .top = {0.5}, .definition = ColorDefinition::normal};
  const double wanted = 0.4;
  const Medium medium = medium_of(look, HalfSpaceColor(look).albedo(wanted), 1.0);
  const LayerStack stack({{.medium = medium, .top = look.top}}, 1.0, look.ior);
  const MonteCarloResult photons = trace_photons(stack, {.photons = 200'000, .seed = 1});
  EXPECT_NEAR(photons.diffuse_reflectance.value, wanted,
              4.0 * photons.diffuse_reflectance.standard_error);
  EXPECT_LT(photons.diffuse_reflectance.standard_error, 1.5e-3);
}

// The text of OpenPBR 1.1.1 defines subsurface_color and gives a fit for it.
TEST(HalfSpaceColor, ByOpenPbrIsNotWhatItsFitGives) {
  const double wanted = 0.5;
  const double s = 4.09712 + 4.20863 * wanted -
                   std::sqrt(9.59217 + 41.6808 * wanted + 17.7126 * wanted * wanted);
  const auto obtained = [&](double ior) {
    return solve_color({.ior = ior, .definition = ColorDefinition::openpbr}, 1.0 - s * s).color;
  };
  EXPECT_NEAR(obtained(1.4), 0.277, 0.001);
  EXPECT_NEAR(obtained(1.0), wanted * (1.0 - 0.125), 0.001);
}

TEST(HalfSpaceColor, OutOfReachIsRefusedWithWhatIsReached) {
  const auto message = [](const HalfSpaceLook& look, double color) -> std::string {
    try {
      (void)HalfSpaceColor(look).albedo(color);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({.ior = 1.4, .definition = ColorDefinition::normal}, 0.98),
            "must be in [0, 0.9722], which is all that this surface reaches, but is 0.98");
  EXPECT_EQ(message({.ior = 1.4, .definition = ColorDefinition::furnace}, 0.05),
            "must be in [0.0769, 1], which is all that this surface reaches, but is 0.05");
  EXPECT_NE(message({}, std::nan("")), "");
  EXPECT_EQ(HalfSpaceColor({.definition = ColorDefinition::normal}).nearest_albedo(0.98), 1.0);
  for (const HalfSpaceLook& look :
       {HalfSpaceLook{.ior = 1.61}, HalfSpaceLook{.ior = 0.99}, HalfSpaceLook{.g = 0.96},
        HalfSpaceLook{.g = -0.31}, HalfSpaceLook{.top = {1.1}}, HalfSpaceLook{.g = std::nan("")}})
    EXPECT_THROW(HalfSpaceColor{look}, InvalidInput);
}

TEST(MediumOf, HasTheRadiusInItsMeaning) {
  const HalfSpaceLook look{.ior = 1.4, .g = 0.8};
  const double radius = 0.25;
  EXPECT_NEAR(mfp(medium_of(look, 0.9, radius)), radius, 1e-15);
  EXPECT_NEAR(mfp_prime(medium_of(look, 0.9, radius, RadiusMeaning::reduced_mean_free_path)),
              radius, 1e-15);
  const Medium spread = medium_of(look, 0.9, radius, RadiusMeaning::diffuse_mean_free_path);
  EXPECT_NEAR(1.0 / sigma_tr(spread), radius, 1e-15);
  EXPECT_NEAR(albedo(spread), 0.9, 1e-15);
  EXPECT_THROW((void)medium_of(look, 1.0, radius, RadiusMeaning::diffuse_mean_free_path),
               InvalidInput);
  EXPECT_THROW((void)medium_of(look, 0.5, 0.0), InvalidInput);
}

}  // namespace
}  // namespace lamina
