// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/shading/thin_sheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/quadrature.h"
#include "lamina/layers/optics/fresnel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr float pi_f = std::numbers::pi_v<float>;

/// An absorbing layer over a scattering one, in air; three bands.
Material two_layers(std::vector<double> sigma_a, double ior) {
  Material material{.name = "leaf", .ior_above = {1, 1, 1}, .ior_below = {1, 1, 1}};
  const std::vector<double> iors{ior, ior, ior};
  material.layers = {{.name = "upper",
                      .sigma_a = sigma_a,
                      .sigma_s = {2, 2, 2},
                      .g = {0, 0, 0},
                      .ior = iors,
                      .thickness = 0.2},
                     {.name = "lower",
                      .sigma_a = {0, 0, 0},
                      .sigma_s = {20, 20, 20},
                      .g = {.5, .5, .5},
                      .ior = iors,
                      .thickness = 0.1}};
  return material;
}

SurfaceMaterial thin(Material material) {
  return {.name = "thin", .surface = ThinSurface{.material = std::move(material)}};
}

TEST(ThinSheet, IsReciprocalAndKeepsItsFlux) {
  const ThinSheet<4> sheet(thin(two_layers({0.5, 2.0, 0.0}, 1.4)));
  const Quadrature rule = gauss_legendre(48, 0.0, 1.0);
  const double leaving = 1.0 - fresnel_diffuse(1.4);
  for (const int side : {0, 1})
    for (const float mu : {0.25f, 0.6f, 1.0f}) {
      const auto at = sheet.fractions({}, side, mu);
      for (int b = 0; b < 3; ++b) {
        double reflected = 0.0, transmitted = 0.0;
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
          const double o = rule.nodes[k];
          const double lobe = rule.weights[k] * 2.0 * o * (1.0 - fresnel(o, 1.4)) / leaving;
          const auto mu_o = static_cast<float>(o);
          reflected += lobe * static_cast<double>(sheet.reflection({}, side, mu, mu_o)[b]);
          transmitted += lobe * static_cast<double>(sheet.transmission({}, side, mu, mu_o)[b]);
        }
        EXPECT_NEAR(reflected, static_cast<double>(at.reflected[b]), 2e-4);
        EXPECT_NEAR(transmitted, static_cast<double>(at.transmitted[b]), 2e-4);
        EXPECT_NEAR(sheet.reflection({}, side, mu, 0.4f)[b],
                    sheet.reflection({}, side, 0.4f, mu)[b], 1e-5f);
        EXPECT_NEAR(sheet.transmission({}, side, mu, 0.4f)[b],
                    sheet.transmission({}, 1 - side, 0.4f, mu)[b], 1e-3f);
      }
      EXPECT_NEAR(at.reflected[2] + at.transmitted[2] + at.straight[2], 1.0f, 1e-3f);
    }
}

/// A sheet in the plane y = 0, seen at an angle from above or below.
Scene sheet_scene(const SurfaceMaterial& material, double mu_o, bool from_below, int samples) {
  Scene scene;
  scene.camera = camera_above(0.01);
  scene.camera.position = {10.0 * std::sqrt(1.0 - mu_o * mu_o), (from_below ? -10.0 : 10.0) * mu_o,
                           0.0};
  scene.camera.up = {0, 0, 1};
  scene.film = {.width = 4, .height = 4};
  scene.render = {.samples_per_pixel = samples, .max_bounces = 0};
  scene.materials = {material};
  scene.meshes = {make_square(100.0f)};
  for (Vec3f& p : scene.meshes[0].positions) p = {p.x, 0.0f, -p.y};
  for (Vec3f& n : scene.meshes[0].normals) n = {0, 1, 0};
  return scene;
}

TEST(ThinSheet, WithoutAbsorptionDisappearsInEvenLight) {
  for (const double ior : {1.0, 1.4})
    for (const bool from_below : {false, true})
      for (const double mu : {1.0, 0.4}) {
        Scene scene = sheet_scene(thin(two_layers({0, 0, 0}, ior)), mu, from_below, 1024);
        scene.lights = {EnvironmentLight{}};
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(mean_of(render(scene).image, c), 1.0, 3e-3) << ior << ' ' << mu;
      }
}

// Light from one half of the sky: by reciprocity the eye sees what the sheet reflects or transmits
// of light that comes from the eye.
TEST(ThinSheet, ShowsTheTotalsOfAddingDoublingOnEitherSide) {
  const Material layers = two_layers({0.5, 2.0, 10.0}, 1.4);
  for (const bool from_below : {false, true})
    for (const bool lit_above : {false, true}) {
      const double mu = 0.7;
      Scene scene = sheet_scene(thin(layers), mu, from_below, 1024);
      Image sky = make_image(64, 32, {"R", "G", "B"});
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 64; ++x)
          for (int c = 0; c < 3; ++c) sky.at(x, lit_above ? y : 31 - y)[c] = 1.0f;
      scene.images = {sky};
      scene.lights = {EnvironmentLight{.image = 0}};
      const Image image = render(scene).image;
      for (std::size_t b = 0; b < 3; ++b) {
        const LayerStack stack = layer_stack(layers, b);
        const SlabTotals totals =
            adding_doubling(from_below ? flipped(stack) : stack, {.theta = std::acos(mu)}).totals;
        const double expected = from_below == lit_above
                                    ? totals.transmittance
                                    : totals.diffuse_reflectance + totals.specular_reflectance;
        EXPECT_NEAR(mean_of(image, b), expected, 0.01 * expected + 2e-3) << b;
      }
    }
}

/// A white floor at y = -5 under sheets of a material at y = 0, 1, ...; the sun stands above.
Scene shaded_floor(const SurfaceMaterial& material, int sheets, int samples) {
  Scene scene = sheet_scene(material, 0.6, false, samples);
  scene.camera.position = {10, 2.5, 0};
  scene.camera.look_at = {0, -5, 0};
  for (Vec3f& p : scene.meshes[0].positions) p = 0.04f * p;
  for (int i = 1; i < sheets; ++i) {
    scene.meshes.push_back(scene.meshes[0]);
    for (Vec3f& p : scene.meshes.back().positions) p.y = static_cast<float>(i);
  }
  Scene floor = sheet_scene(diffuse_material(1.0f), 1.0, false, 1);
  for (Vec3f& p : floor.meshes[0].positions) p.y = -5.0f;
  floor.meshes[0].material = {1, 1};
  scene.meshes.push_back(floor.meshes[0]);
  scene.materials.push_back(floor.materials[0]);
  scene.lights = {DirectionalLight{.direction = {0, 1, 0}, .irradiance = {pi_f, pi_f, pi_f}}};
  return scene;
}

// A map of the thickness is looked up in a table over thickness.
TEST(ThinSheet, OfMappedThicknessIsThatOfItsThickness) {
  const Material layers = two_layers({0.5, 2.0, 10.0}, 1.4);  // 0.3 mm
  Image map = make_image(3, 1, {"Y"});
  map.pixels = {0.05f, 0.27f, 1.9f};
  const std::vector<Image> images = {map};
  const TextureStore textures(images);
  SurfaceMaterial mapped = thin(layers);
  std::get<ThinSurface>(mapped.surface).thickness =
      ScalarParameter{.value = 1.0f, .map = TextureMap{.source = ImageMap{}}};
  const ThinSheet<4> sheet(mapped);
  for (std::size_t i = 0; i < 3; ++i) {
    SurfacePoint point;
    point.uv = {(static_cast<float>(i) + 0.5f) / 3.0f, 0.5f};
    const auto place = sheet.place_at(textures, point);
    for (int b = 0; b < 3; ++b)
      for (const bool from_below : {false, true}) {
        Material scaled = layers;
        for (MaterialLayer& layer : scaled.layers) layer.thickness *= double{map.pixels[i]} / 0.3;
        const LayerStack stack = layer_stack(scaled, static_cast<std::size_t>(b));
        const AddingDoublingTotals exact = adding_doubling(from_below ? flipped(stack) : stack);
        const double entered = 1.0 - exact.totals.specular_reflectance;
        const auto at = sheet.fractions(place, from_below ? 1 : 0, 1.0f);
        EXPECT_NEAR(double{at.reflected[b]} * entered, exact.totals.diffuse_reflectance, 0.01);
        EXPECT_NEAR(double{at.transmitted[b] + at.straight[b]} * entered,
                    exact.totals.transmittance, 0.01);
      }
  }
}

TEST(ThinSheet, DimsTheSunByWhatPassesUnscattered) {
  const Material layers = two_layers({0.5, 2.0, 10.0}, 1.4);
  for (const int sheets : {1, 2}) {
    const Image image = render(shaded_floor(thin(layers), sheets, 4)).image;
    for (std::size_t b = 0; b < 3; ++b)
      EXPECT_NEAR(
          mean_of(image, b),
          std::pow(adding_doubling(layer_stack(layers, b)).unscattered_transmittance, sheets), 2e-4)
          << b;
  }
}

TEST(Opacity, LetsLightThroughWhereThereIsNothing) {
  SurfaceMaterial card = diffuse_material(0.0f);
  card.opacity = ScalarParameter{.value = 0.25f, .map = {}};
  EXPECT_NEAR(mean_of(render(shaded_floor(card, 2, 4)).image, 0), 0.75 * 0.75, 1e-4);
  // Seen through the cards, too.
  Scene scene = shaded_floor(card, 1, 4096);
  scene.camera.position = {0, 40, 0};
  EXPECT_NEAR(mean_of(render(scene).image, 0), 0.75 * 0.75, 5e-3);
}

TEST(ThinSheet, RefusesLayersWithoutAnotherSide) {
  Material deep = two_layers({0, 0, 0}, 1.4);
  deep.layers.back().thickness = std::numeric_limits<double>::infinity();
  EXPECT_THROW(ThinSheet<4>{thin(deep)}, InvalidInput);
  Material grounded = two_layers({0, 0, 0}, 1.4);
  grounded.ground.reflectance = 0.5;
  EXPECT_THROW(ThinSheet<4>{thin(grounded)}, InvalidInput);
}

}  // namespace
}  // namespace lamina
