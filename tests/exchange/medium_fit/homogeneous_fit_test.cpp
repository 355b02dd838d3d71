// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/exchange/medium_fit/homogeneous_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/exchange/medium_fit/channel_light.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

/// A material of the same layers in bands R, G, B but for absorption.
Material material_of(const std::vector<Medium>& media, const std::vector<double>& thicknesses,
                     double ior_below) {
  Material material{.name = "test", .ior_above = {1.0, 1.0, 1.0}};
  material.ior_below.assign(3, ior_below);
  for (std::size_t l = 0; l < media.size(); ++l) {
    const Medium& m = media[l];
    material.layers.push_back({.name = "layer",
                               .sigma_a = {m.sigma_a, 2.0 * m.sigma_a, 8.0 * m.sigma_a},
                               .sigma_s = {m.sigma_s, m.sigma_s, m.sigma_s},
                               .g = {m.g, m.g, m.g},
                               .ior = {m.ior, m.ior, m.ior},
                               .thickness = thicknesses[l]});
  }
  return material;
}

constexpr Medium milky{.sigma_a = 0.05, .sigma_s = 10.0, .g = 0.5, .ior = 1.4};

HomogeneousFit fit_of(const Material& material, const HomogeneousFitOptions& options = {}) {
  const std::vector<LayerStack> stacks = layer_stacks(material);
  return fit_homogeneous(channel_light(material, stacks, ExportChannels::rgb), stacks, options);
}

TEST(HomogeneousFit, TakesASingleLayerAsItIs) {
  const HomogeneousFit fit = fit_of(material_of({milky}, {INFINITY}, milky.ior));
  EXPECT_TRUE(fit.is_exact);
  EXPECT_EQ(fit.media[1].sigma_a, 0.1);
  EXPECT_EQ(fit.media[1].sigma_s, 10.0);
  for (const ChannelMisfit& misfit : fit.misfits)
    EXPECT_EQ(misfit.reflectance.spread->profile_rms, 0.0);
}

// What is cut in two and fitted as layers must come out as the one medium that it is.
TEST(HomogeneousFit, FindsTheMediumOfAHalfSpaceThatWasCutInTwo) {
  const Material cut = material_of({milky, milky}, {0.3, INFINITY}, milky.ior);
  for (const FitGoal goal : {FitGoal::profile, FitGoal::mean_square_radius}) {
    const HomogeneousFit fit = fit_of(cut, {.g = milky.g, .goal = goal});
    ASSERT_FALSE(fit.is_exact);
    ASSERT_FALSE(fit.is_thin());
    for (std::size_t c = 0; c < 3; ++c) {
      const double sigma_a = cut.layers[0].sigma_a[c];
      EXPECT_NEAR(fit.media[c].sigma_a, sigma_a, 0.01 * sigma_a);
      EXPECT_NEAR(fit.media[c].sigma_s, milky.sigma_s, 0.01 * milky.sigma_s);
      EXPECT_LT(fit.misfits[c].reflectance.spread->profile_rms, 0.02);
    }
  }
}

TEST(HomogeneousFit, FindsTheMediumOfASheetThatWasCutInTwo) {
  const Material cut = material_of({milky, milky}, {0.2, 0.3}, 1.0);
  const HomogeneousFit fit = fit_of(cut);  // g is found, too
  ASSERT_TRUE(fit.is_thin());
  EXPECT_DOUBLE_EQ(fit.g(), milky.g);
  EXPECT_DOUBLE_EQ(fit.thickness, 0.5);
  for (std::size_t c = 0; c < 3; ++c) {
    const double sigma_a = cut.layers[0].sigma_a[c];
    EXPECT_NEAR(fit.media[c].sigma_a, sigma_a, 0.01 * sigma_a);
    EXPECT_NEAR(fit.media[c].sigma_s, milky.sigma_s, 0.01 * milky.sigma_s);
    EXPECT_LT(fit.misfits[c].transmittance->spread->profile_rms, 0.03);
  }
}

// Skin by one medium: the color is right, the profile is not, and the misfit says so.
TEST(HomogeneousFit, OfLayersHasTheirColorAndSaysHowWrongItsProfileIs) {
  const Material layered = material_of({{.sigma_a = 2.0, .sigma_s = 40.0, .g = 0.0, .ior = 1.4},
                                        {.sigma_a = 0.05, .sigma_s = 20.0, .g = 0.8, .ior = 1.4}},
                                       {0.05, INFINITY}, 1.4);
  const HomogeneousFit near = fit_of(layered);
  const HomogeneousFit wide = fit_of(layered, {.goal = FitGoal::mean_square_radius});
  for (std::size_t c = 0; c < 3; ++c) {
    const LightMisfit& by_profile = near.misfits[c].reflectance;
    const LightMisfit& by_radius = wide.misfits[c].reflectance;
    EXPECT_NEAR(by_profile.obtained_total, by_profile.wanted_total, 2e-5);
    EXPECT_NEAR(by_radius.obtained_total, by_radius.wanted_total, 2e-5);
    EXPECT_GT(by_profile.spread->profile_rms, 0.1);
    EXPECT_LT(by_profile.spread->profile_rms, by_radius.spread->profile_rms);
    EXPECT_NEAR(by_radius.spread->obtained_mean_square_radius,
                by_radius.spread->wanted_mean_square_radius,
                0.01 * by_radius.spread->wanted_mean_square_radius);
  }
}

TEST(HomogeneousFit, RefusesWhatDoesNotScatter) {
  const Material clear = material_of({{.sigma_a = 1.0, .ior = 1.4}}, {1.0}, 1.0);
  EXPECT_THROW((void)fit_of(clear), InvalidInput);
}

TEST(ChannelLight, OfASpectralMaterialHasTheColorOfItsSpectrum) {
  Material material{.name = "test", .bands = BandSet({450.0, 550.0, 650.0})};
  material.ior_above = material.ior_below = {1.0, 1.0, 1.0};
  material.layers = {{.name = "layer",
                      .sigma_a = {0.5, 0.1, 0.05},
                      .sigma_s = {5.0, 4.0, 3.0},
                      .g = {0.0, 0.0, 0.0},
                      .ior = {1.0, 1.0, 1.0}}};
  const std::vector<LayerStack> stacks = layer_stacks(material);
  const ChannelLight light = channel_light(material, stacks, ExportChannels::rgb);
  std::vector<double> spectrum;
  for (const auto& of_band : adding_doubling(stacks, {.is_diffuse = true}))
    spectrum.push_back(of_band.totals.diffuse_reflectance);
  const LinearSrgb color = linear_srgb(make_band_weights(material.bands), spectrum);
  EXPECT_TRUE(light.channels.are_converted);
  EXPECT_NEAR(light.profile.total_reflectance[0], color[0], 1e-6);
  EXPECT_NEAR(light.profile.total_reflectance[2], color[2], 1e-6);
}

/// A Gaussian of unit flux.
Profile gaussian_profile(double variance, double flux) {
  Profile profile{.per = ProfilePer::arriving_flux, .bands = 1};
  for (double r = 1e-3; r < 30.0; r *= 1.05) {
    profile.r.push_back(r);
    profile.reflectance_profile.push_back(flux * std::exp(-r * r / (2.0 * variance)) /
                                          (2.0 * std::numbers::pi * variance));
  }
  profile.transmittance_profile.assign(profile.r.size(), 0.0);
  profile.total_reflectance = {flux};
  profile.total_transmittance = {0.0};
  return profile;
}

TEST(ProfileDifference, OfAProfileThatIsATenthBrighterIsATenthOverTheMean) {
  const Profile one = gaussian_profile(0.5, 0.4), brighter = gaussian_profile(0.5, 0.44);
  EXPECT_NEAR(profile_difference(one, brighter, 0, true), 0.1 / 1.05, 1e-12);
  EXPECT_EQ(profile_difference(one, one, 0, true), 0.0);
}

TEST(MeanSquareRadius, OfAGaussianIsTwiceItsVariance) {
  EXPECT_NEAR(mean_square_radius(gaussian_profile(0.5, 0.4), 0, true), 1.0, 1e-4);
}

}  // namespace
}  // namespace lamina
