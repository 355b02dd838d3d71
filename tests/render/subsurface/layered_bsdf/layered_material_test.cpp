// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/layered_bsdf/layered_material.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/layered_bsdf/layered_bsdf.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;

/// Pigment in a thin layer over a half-space; a second part scatters.
Material skin(double pigment, double ior = 1.4) {
  Material material{.name = "skin", .ior_above = {1, 1, 1}, .ior_below = {ior, ior, ior}};
  const std::vector<double> iors{ior, ior, ior};
  material.layers = {{.name = "epidermis",
                      .sigma_a = {0.5, 0.8, 1.2},
                      .sigma_s = {20, 20, 20},
                      .g = {.6, .6, .6},
                      .ior = iors,
                      .thickness = 0.05,
                      .mixture = {{.name = "pigment",
                                   .fraction = pigment,
                                   .sigma_a = {40, 60, 100},
                                   .sigma_s = {5, 5, 5},
                                   .g = {0, 0, 0}}}},
                     {.name = "dermis",
                      .sigma_a = {0.1, 0.4, 0.5},
                      .sigma_s = {15, 15, 15},
                      .g = {.7, .7, .7},
                      .ior = iors}};
  return material;
}

/// Fresnel reflectance, mean over the cosine: not weighted by it, as a flux would be.
double mean_fresnel(double eta) {
  constexpr int nodes = 2000;
  double sum = 0.0;
  for (int i = 0; i < nodes; ++i) sum += fresnel((i + 0.5) / nodes, eta);
  return sum / nodes;
}

/// 4 pi times a Henyey-Greenstein phase function, mean over the directions of light above a plane.
double mean_phase(double theta_o, double g) {
  constexpr int nodes = 400;
  double sum = 0.0;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const double mu = (i + 0.5) / nodes, phi = pi * (j + 0.5) / nodes;
      const double turned =
          -mu * std::cos(theta_o) - std::sqrt(1.0 - mu * mu) * std::sin(theta_o) * std::cos(phi);
      sum += (1.0 - g * g) / std::pow(1.0 + g * g - 2.0 * g * turned, 1.5);
    }
  return sum / (nodes * nodes);
}

/// A plate in the plane y = 0, seen and lit at angles from its normal, in one plane.
Scene plate(Material material, double theta_o, double theta_i) {
  Scene scene;
  scene.camera = camera_above(0.01);
  scene.camera.position = {10.0 * std::sin(theta_o), 10.0 * std::cos(theta_o), 0.0};
  scene.camera.up = {0, 0, 1};
  scene.film = {.width = 4, .height = 4};
  scene.render = {
      .method = RenderSettings::Method::layered_bsdf, .samples_per_pixel = 1, .max_bounces = 0};
  scene.materials = {{.name = "skin", .surface = SubsurfaceSurface{.material = material}}};
  scene.meshes = {make_square(100.0f)};
  for (Vec3f& p : scene.meshes[0].positions) p = {p.x, 0.0f, -p.y};
  for (Vec3f& n : scene.meshes[0].normals) n = {0, 1, 0};
  scene.lights = {DirectionalLight{.direction = {-std::sin(theta_i), std::cos(theta_i), 0.0},
                                   .irradiance = {1, 1, 1}}};
  return scene;
}

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

TEST(LayeredMaterial, PlateHasTheRadianceOfTheBsdf) {
  for (const double theta_i : {0.2, 1.2}) {
    const Scene scene = plate(skin(0.02), 0.7, theta_i);
    const RenderResult result = render(scene);
    const std::vector<double> theta_o{0.7}, phi_o{0.0};
    for (std::size_t band = 0; band < 3; ++band) {
      const StackBsdf expected = layered_bsdf(layer_stack(skin(0.02), band), ScatteringOrders::all,
                                              theta_i, theta_o, phi_o);
      EXPECT_NEAR(mean_of(result.image, band), expected.brdf[0] * std::cos(theta_i),
                  2e-3 * expected.brdf[0])
          << theta_i << " " << band;
    }
  }
}

// Under uniform light the surface returns what adding-doubling says, mirrors included.
TEST(LayeredMaterial, UniformLightComesBackAsAddingDoublingSays) {
  Scene scene = plate(skin(0.02), 1.0, 0.0);
  scene.lights = {EnvironmentLight{}};
  scene.render.samples_per_pixel = 1024;
  const RenderResult result = render(scene);
  for (std::size_t band = 0; band < 3; ++band) {
    const SlabTotals totals = adding_doubling(layer_stack(skin(0.02), band), {.theta = 1.0}).totals;
    EXPECT_NEAR(mean_of(result.image, band),
                totals.diffuse_reflectance + totals.specular_reflectance, 3e-3);
  }
}

// Light and surface sampling alone give what both together give: values and densities agree.
TEST(LayeredMaterial, WaysToFindLightAgree) {
  Scene scene = plate(skin(0.02), 1.3, 0.0);
  scene.lights = {RectangleLight{
      .center = {-20, 8, 0}, .edge_u = {0, 10, 0}, .edge_v = {0, 0, 40}, .radiance = {1, 1, 1}}};
  const auto mean = [&](RenderOptions::DirectLight way) {
    scene.render.samples_per_pixel = 4096;
    scene.render.max_bounces = 1;
    return mean_of(render(scene, {.direct_light = way}).image, 1);
  };
  const double lights = mean(RenderOptions::DirectLight::lights_only);
  EXPECT_GT(lights, 0.0);
  EXPECT_NEAR(mean(RenderOptions::DirectLight::surfaces_only), lights, 0.03 * lights);
  EXPECT_NEAR(mean(RenderOptions::DirectLight::combined), lights, 0.02 * lights);
}

// Random paths below the surface: the BSDF of adding-doubling, whichever way light is found.
TEST(LayeredMaterial, RandomWalkConvergesToAddingDoubling) {
  Scene scene = plate(skin(0.02), 0.7, 0.5);
  scene.render.orders = LayeredOrders::random_walk;
  scene.render.samples_per_pixel = 1024;
  const std::vector<double> theta_o{0.7}, phi_o{0.0};
  const RenderResult lit = render(scene);
  for (std::size_t band = 0; band < 3; ++band) {
    const double expected =
        stack_bsdf(layer_stack(skin(0.02), band), 0.5, theta_o, phi_o).brdf[0] * std::cos(0.5);
    EXPECT_NEAR(mean_of(lit.image, band), expected, 0.015 * expected) << band;
  }
  scene.lights = {EnvironmentLight{}};
  const SlabTotals totals = adding_doubling(layer_stack(skin(0.02), 1), {.theta = 0.7}).totals;
  for (const auto way :
       {RenderOptions::DirectLight::combined, RenderOptions::DirectLight::lights_only,
        RenderOptions::DirectLight::surfaces_only})
    EXPECT_NEAR(mean_of(render(scene, {.direct_light = way}).image, 1),
                totals.diffuse_reflectance + totals.specular_reflectance, 0.01);
}

TEST(LayeredMaterial, FactorsAreShownUnshaded) {
  Scene scene = plate(skin(0.02), 0.7, 0.5);
  scene.render.factors = {.seeliger = true};
  const double mu_i = std::sqrt(1.0 - std::pow(std::sin(0.5) / 1.4, 2)),
               mu_o = std::sqrt(1.0 - std::pow(std::sin(0.7) / 1.4, 2));
  EXPECT_NEAR(mean_of(render(scene).image, 0), mu_i / (mu_i + mu_o), 1e-4);
  scene.render.factors = {.fresnel = true, .phase = true};
  const double turned = std::sin(0.5) * std::sin(0.7) / (1.4 * 1.4) - mu_i * mu_o;
  const PhaseFunction phase = phase_function(layer_stack(skin(0.02), 0).layers()[0]);
  EXPECT_NEAR(mean_of(render(scene).image, 0),
              (1.0 - fresnel(std::cos(0.5), 1.4)) * (1.0 - fresnel(std::cos(0.7), 1.4)) * 4.0 * pi *
                  evaluate(phase, turned),
              1e-4);
}

// In even light of radiance 1 / (2 pi) a factor is its mean over the hemisphere, and nothing is
// mirrored. Seeliger: the integral of mu / (mu + mu_o) over mu is 1 - mu_o ln(1 + 1 / mu_o).
TEST(LayeredMaterial, FactorsInEvenLightAreTheirMean) {
  const auto mean = [&](LayeredFactors factors, double theta_o, double ior, double g) {
    Material material = skin(0.0, ior);
    material.layers[0].g = {g, g, g};
    Scene scene = plate(material, theta_o, 0.0);
    const auto l = static_cast<float>(0.5 / pi);
    scene.lights = {EnvironmentLight{.scale = {l, l, l}}};
    scene.render.factors = factors;
    scene.render.samples_per_pixel = 4096;
    return mean_of(render(scene).image, 1);
  };
  for (const double theta_o : {0.3, 1.2}) {
    const double mu_o = std::cos(theta_o);
    EXPECT_NEAR(mean({.seeliger = true}, theta_o, 1.0, 0.5),
                1.0 - mu_o * std::log(1.0 + 1.0 / mu_o), 2e-3);
  }
  EXPECT_NEAR(mean({.fresnel = true}, 0.3, 1.4, 0.5),
              (1.0 - fresnel(std::cos(0.3), 1.4)) * (1.0 - mean_fresnel(1.4)), 2e-3);
  for (const double theta_o : {0.3, 1.2})
    EXPECT_NEAR(mean({.phase = true}, theta_o, 1.0, 0.75), mean_phase(theta_o, 0.75), 3e-3);
}

// Maps that vary nothing, and values between the rows of the table.
TEST(LayeredMaterial, MapsSetTheirQuantities) {
  const Scene expected = plate(skin(0.013), 0.7, 0.5);
  Scene mapped = plate(skin(0.3), 0.7, 0.5);
  surface_of(mapped).maps = {
      {.layer = 0, .quantity = LayerMap::Quantity::fraction, .terms = {{.value = 0.013f}}}};
  const double wanted = mean_of(render(expected).image, 1);
  EXPECT_NEAR(mean_of(render(mapped).image, 1), wanted, 2e-3 * wanted);

  mapped.images = {make_image(2, 1, {"R", "G", "B"})};
  for (int c = 0; c < 3; ++c) mapped.images[0].at(1, 0)[c] = 1.0f;  // pigment in [0, 0.1]
  surface_of(mapped).maps[0].terms = {{.value = 0.1f, .map = TextureMap{.source = ImageMap{}}}};
  mapped.meshes[0].uvs.assign(4, {0.25f + 0.5f * 0.13f, 0.5f});
  EXPECT_NEAR(mean_of(render(mapped).image, 1), wanted, 1e-2 * wanted);

  Scene thin = plate(skin(0.02), 0.7, 0.5);
  surface_of(thin).maps = {
      {.layer = 0, .quantity = LayerMap::Quantity::thickness, .terms = {{.value = 0.001f}}},
      {.layer = 1, .quantity = LayerMap::Quantity::sigma_a, .terms = {{.value = 2.0f}}}};
  Material material = skin(0.02);
  material.layers[0].thickness = 0.001;
  for (double& sigma : material.layers[1].sigma_a) sigma *= 2.0;
  const double thin_wanted = mean_of(render(plate(material, 0.7, 0.5)).image, 0);
  EXPECT_NEAR(mean_of(render(thin).image, 0), thin_wanted, 2e-3 * thin_wanted);
}

// Numbers of a recipe of skin, between the rows of the table; the tops of layers stay as they are.
TEST(LayeredMaterial, MapsVaryNumbersOfSkin) {
  const auto recipe = [](double melanin) {
    std::ostringstream text;
    text << R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [470, 550, 620],
      "surface": { "roughness": 0.3 }, "skin": { "melanin": )"
         << melanin << " } }";
    return parse_material(text.str(), "test");
  };
  Scene expected = plate(recipe(0.033), 0.7, 0.5);
  Scene mapped = plate(recipe(0.4), 0.7, 0.5);
  mapped.images = {make_image(2, 1, {"R", "G", "B"})};
  for (int c = 0; c < 3; ++c) mapped.images[0].at(1, 0)[c] = 1.0f;
  mapped.meshes[0].uvs.assign(4, {0.25f + 0.5f * 0.33f, 0.5f});
  const auto number = [](std::string_view name) {
    const auto ranges = skin_parameter_ranges();
    const auto found = std::ranges::find(ranges, name, &SkinParameterRange::name);
    return static_cast<std::size_t>(found - ranges.begin());
  };
  surface_of(mapped).maps = {{.quantity = LayerMap::Quantity::skin,
                              .part = number("melanin"),
                              .terms = {{.value = 0.1f, .map = TextureMap{.source = ImageMap{}}}}}};
  // Layers are exact between rows; the higher orders are interpolated.
  for (const auto& [orders, tolerance] :
       {std::pair(LayeredOrders::first, 1e-3), std::pair(LayeredOrders::all, 1.5e-2)}) {
    mapped.render.orders = expected.render.orders = orders;
    const Image a = render(mapped).image, b = render(expected).image;
    for (std::size_t band = 0; band < 3; ++band)
      EXPECT_NEAR(mean_of(a, band), mean_of(b, band), tolerance * mean_of(b, band)) << band;
  }
}

// An oily coat takes the place of the surface: what it reflects does not get in.
TEST(LayeredMaterial, CoatReflectsBeforeTheLayers) {
  Scene scene = plate(skin(0.02), 0.7, 0.5);
  const double bare = mean_of(render(scene).image, 1);
  scene.materials[0].coat = Coat{.ior = 1.4f, .roughness = {.value = 0.1f}};
  const RenderResult coated = render(scene);
  const std::size_t below = *channel_index(coated.image, "subsurface.G");
  EXPECT_NEAR(mean_of(coated.image, below), bare, 0.02 * bare);  // of the same index
  scene.materials[0].coat->ior = 2.5f;
  EXPECT_LT(mean_of(render(scene).image, below), 0.75 * bare);
}

TEST(LayeredMaterial, WhatItCannotDoIsRefused) {
  const auto refusal = [](const Scene& scene) {
    try {
      (void)render(scene);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Scene scene = plate(skin(0.02), 0.7, 0.5);
  surface_of(scene).maps.resize(5, {.terms = {{.value = 0.1f}}});
  EXPECT_NE(refusal(scene).find("at most 4"), std::string::npos);
  scene = plate(skin(0.02), 0.7, 0.5);
  surface_of(scene).material.layers[1].top.roughness = 0.2;
  EXPECT_NE(refusal(scene).find("material \"skin\": layer 1: first order needs smooth boundaries"),
            std::string::npos);
}

}  // namespace
}  // namespace lamina
