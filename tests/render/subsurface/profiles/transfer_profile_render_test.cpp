// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/render/subsurface/profiles/absorption_series.h"
#include "lamina/render/subsurface/profiles/profile_maker.h"
#include "lamina/solve/reflectance/material_totals.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// Two layers; three bands that absorb ever more.
Material slab() {
  Material material{.name = "slab", .ior_above = {1, 1, 1}, .ior_below = {1, 1, 1}};
  material.layers = {{.name = "skin",
                      .sigma_a = {0.1, 1.0, 5.0},
                      .sigma_s = {20, 20, 20},
                      .g = {0.5, 0.5, 0.5},
                      .ior = {1.4, 1.4, 1.4},
                      .thickness = 0.1},
                     {.name = "flesh",
                      .sigma_a = {0.01, 0.1, 0.5},
                      .sigma_s = {5, 5, 5},
                      .g = {0, 0, 0},
                      .ior = {1.35, 1.35, 1.35},
                      .thickness = 2.0}};
  return material;
}

TEST(DiffuseTransferProfile, HasTheTotalsOfAddingDoublingPerEnteredFlux) {
  const Profile profile = diffuse_transfer_profile(layer_stacks(slab()), std::nullopt);
  EXPECT_EQ(profile.per, ProfilePer::entered_flux);
  for (std::size_t b = 0; b < 3; ++b) {
    const auto totals = adding_doubling(layer_stack(slab(), b), {.is_diffuse = true}).totals;
    const double entered = 1.0 - fresnel_diffuse(1.4);
    EXPECT_NEAR(profile.total_reflectance[b], totals.diffuse_reflectance / entered, 1e-4);
    EXPECT_NEAR(profile.total_transmittance[b], totals.transmittance / entered, 1e-4);
    const FluxCurve flux = reflected_flux(profile, b);
    EXPECT_NEAR((flux.within.back() + flux.beyond) / profile.total_reflectance[b], 1.0, 0.01);
  }
}

// What the facets of the top do inside is in the profile. Those of the lowest boundary are the
// renderer's business.
TEST(DiffuseTransferProfile, HasARoughTopAndASmoothBottom) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / "lamina_exact_profile_render_test";
  std::filesystem::remove_all(folder);
  Material smooth = slab();  // one layer is fast
  smooth.layers = {{.name = "marble",
                    .sigma_a = {0.002, 0.02, 0.2},
                    .sigma_s = {2, 2, 2},
                    .g = {0, 0, 0},
                    .ior = {1.5, 1.5, 1.5},
                    .thickness = 5.0}};
  Material rough = smooth;
  rough.layers[0].top.roughness = 1.0;
  const Profile profile = diffuse_transfer_profile(layer_stacks(rough), DiskCache{folder});
  for (std::size_t b = 0; b < 3; ++b) {
    const auto of = [&](const Material& material) {
      const auto totals = adding_doubling(layer_stack(material, b), {.is_diffuse = true}).totals;
      return totals.diffuse_reflectance / (1.0 - totals.specular_reflectance);
    };
    EXPECT_NEAR(profile.total_reflectance[b], of(rough), 5e-4) << b;
    if (b == 2) continue;  // too dark for a difference
    EXPECT_GT(of(rough), of(smooth) + 2e-3) << b;
  }
  Material on_frost = rough;
  on_frost.ground.top.roughness = 0.5;
  EXPECT_EQ(diffuse_transfer_profile(layer_stacks(on_frost), DiskCache{folder}).reflectance_profile,
            profile.reflectance_profile);
  std::filesystem::remove_all(folder);
  Material clear = slab();
  for (MaterialLayer& layer : clear.layers) layer.sigma_s[2] = 0.0;
  EXPECT_THROW((void)diffuse_transfer_profile(layer_stacks(clear), std::nullopt), InvalidInput);
}

// The exact profile has the light scattered once, which diffusion lacks.
TEST(DiffuseTransferProfile, IsRefusedBesideSingleScattering) {
  Scene scene;
  scene.camera = camera_above(0.5);
  scene.film = {.width = 2, .height = 2};
  scene.render.profile = RenderSettings::Profile::radiative_transfer;
  scene.render.single_scattering = RenderSettings::SingleScattering::straight;
  scene.render.samples_per_pixel = 1;
  scene.materials = {{.name = "slab", .surface = SubsurfaceSurface{.material = slab()}}};
  scene.meshes = {make_square(60.0f)};
  scene.lights = {EnvironmentLight{}};
  try {
    (void)render(scene);
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("single_scattering must be \"none\""),
              std::string::npos)
        << error.what();
  }
}

// Even light from all sides: seen along the normal, what a slab sends back of diffuse light.
TEST(SubsurfaceFurnace, TransferProfileReturnsTheSlabTotal) {
  setenv("LAMINA_CACHE", "off", 1);
  Scene scene;
  scene.camera = camera_above(0.5);
  scene.film = {.width = 8, .height = 8};
  scene.render = {.method = RenderSettings::Method::probe,
                  .profile = RenderSettings::Profile::radiative_transfer,
                  .samples_per_pixel = 256,
                  .max_bounces = 0};
  scene.materials = {
      {.name = "slab",
       .surface = SubsurfaceSurface{.material = slab(), .thickness = {.value = 0.0f}}}};
  scene.meshes = {make_square(60.0f)};
  scene.lights = {EnvironmentLight{}};
  const Image image = render(scene).image;
  for (std::size_t b = 0; b < 3; ++b) {
    const auto totals = adding_doubling(layer_stack(slab(), b), {.is_diffuse = true}).totals;
    const double mirrored = fresnel(1.0, 1.4);
    const double inside =
        totals.diffuse_reflectance * (1.0 - mirrored) / (1.0 - fresnel_diffuse(1.4));
    EXPECT_NEAR(mean_of(image, b), mirrored + inside, 3e-3) << b;
  }
}

// By radiative transfer, unless light scattered once is added or it refuses the layers.
TEST(ProfileMaker, SaysWhereProfilesComeFrom) {
  using Source = RenderSettings::Profile;
  const Material plain = slab();
  EXPECT_EQ(ProfileMaker(RenderSettings{}).source(plain), Source::radiative_transfer);
  EXPECT_FALSE(transfer_refusal(plain));
  RenderSettings with_once;
  with_once.single_scattering = RenderSettings::SingleScattering::straight;
  EXPECT_EQ(ProfileMaker(with_once).source(plain), Source::diffusion);
  EXPECT_EQ(ProfileMaker(RenderSettings{.profile = Source::dipole}).source(plain), Source::dipole);
  Material by_look = slab();
  by_look.is_by_diffusion = true;
  EXPECT_EQ(ProfileMaker(RenderSettings{}).source(by_look), Source::diffusion);
  Material varnished = slab();  // clear and rough
  varnished.layers[0].sigma_s = varnished.layers[0].sigma_a = {0, 0, 0};
  varnished.layers[0].top.roughness = 0.5;
  ASSERT_TRUE(transfer_refusal(varnished));
  EXPECT_EQ(ProfileMaker(RenderSettings{}).source(varnished), Source::diffusion);
  const ProfileMaker named(RenderSettings{.profile = Source::radiative_transfer});
  EXPECT_EQ(named.source(varnished), Source::radiative_transfer);
  EXPECT_THROW((void)named(varnished, layer_stacks(varnished)), InvalidInput);
}

// Half-spaces of one layer come from a table, whatever they absorb: what an inverted color wants.
TEST(ProfileMaker, AbsorptionThatMeetsAColorReflectsIt) {
  setenv("LAMINA_CACHE", "off", 1);
  Material wax = half_space({0.1, 0.1, 0.1}, 2.0, 1.0);
  wax.layers[0].sigma_s = {1.5, 2.0, 2.5};
  const std::vector<LayerStack> layers = layer_stacks(wax);
  const std::vector<double> color = {0.8, 0.35, 0.06};
  const AbsorptionSeries series(layers, {.darkest = color, .brightest = color},
                                ProfileMaker(RenderSettings{}).of_any_absorption(wax, layers));
  for (std::size_t b = 0; b < color.size(); ++b) {
    const LayerStack found = with_absorption(layers[b], series.factor(color[b], b));
    EXPECT_NEAR(material_totals(found).reflectance, color[b], 1e-3 * color[b]) << b;
  }
}

/// How far two profiles are apart, weighted by the flux of rings, relative, the most of all bands.
double mean_difference(const Profile& a, const Profile& b) {
  double most = 0.0;
  for (std::size_t band = 0; band < a.bands; ++band) {
    double wrong = 0.0, all = 0.0;
    for (std::size_t i = 0; i < a.r.size(); ++i) {
      const double ring = a.r[i] * a.r[i];
      wrong += ring * std::abs(a.reflectance_at(i, band) - b.reflectance_at(i, band));
      all += ring * b.reflectance_at(i, band);
    }
    most = std::max(most, wrong / all);
  }
  return most;
}

TEST(ProfileMaker, SmoothTopsStandInForRoughOnes) {
  struct Case {
    double ior;
    double of_rough, of_rougher;  ///< the largest differences at a roughness of .2 and .4
  };
  for (const auto& [ior, of_rough, of_rougher] : {Case{1.33, 0.015, 0.04}, Case{1.5, 0.012, 0.03}}) {
    Material material{.name = "stone", .ior_above = {1, 1, 1}, .ior_below = {ior, ior, ior}};
    material.layers = {{.name = "stone",
                        .sigma_a = {0.002, 0.1, 2.0},
                        .sigma_s = {2, 3, 10},
                        .g = {0, 0, 0.8},
                        .ior = {ior, ior, ior},
                        .thickness = std::numeric_limits<double>::infinity()}};
    const ProfileMaker make_profile(RenderSettings{});
    const auto made = [&] { return make_profile(material, layer_stacks(material)); };
    const Profile smooth = made();
    for (const auto& [roughness, most] : {std::array{0.2, of_rough}, {0.4, of_rougher}}) {
      material.layers[0].top.roughness = roughness;
      const Profile rough = diffuse_transfer_profile(layer_stacks(material), std::nullopt);
      EXPECT_LT(mean_difference(made(), rough), most) << ior << ' ' << roughness;
      EXPECT_GT(mean_difference(smooth, rough), 2.0 * most) << ior << ' ' << roughness;
      for (std::size_t b = 0; b < 3; ++b)
        EXPECT_NEAR(made().total_reflectance[b] / rough.total_reflectance[b], 1.0, most)
            << ior << ' ' << roughness;
    }
  }
}

}  // namespace
}  // namespace lamina
