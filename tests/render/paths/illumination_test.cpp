// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

constexpr double pi = std::numbers::pi;
constexpr float pi_f = std::numbers::pi_v<float>;

/// One pixel's worth of the middle of a square of reflectance 1, so that radiance = irradiance /
/// pi.
Scene white_square(int samples) {
  Scene scene;
  scene.camera = camera_above(0.01);
  scene.film = {.width = 4, .height = 4};
  scene.render = {.samples_per_pixel = samples, .max_bounces = 0};
  scene.materials = {diffuse_material(1.0f)};
  scene.meshes = {make_square(100.0f)};
  return scene;
}

TEST(Lights, PointLightFallsOffWithDistanceSquaredAndCosine) {
  Scene scene = white_square(1);
  scene.lights = {PointLight{.position = {30, 0, 40}, .intensity = {1000, 2000, 3000}}};
  const Image image = render(scene).image;
  for (std::size_t c = 0; c < 3; ++c) {
    const double irradiance = 1000.0 * static_cast<double>(c + 1) * 0.8 / (50.0 * 50.0);
    EXPECT_NEAR(mean_of(image, c), irradiance / pi, 1e-4 * irradiance);
  }
}

TEST(Lights, DirectionalLightGivesItsIrradianceTimesTheCosine) {
  Scene scene = white_square(1);
  scene.lights = {DirectionalLight{.direction = {0.6, 0, 0.8}, .irradiance = {pi_f, pi_f, pi_f}}};
  EXPECT_NEAR(mean_of(render(scene).image, 0), 0.8, 1e-4);
}

/// Irradiance at the origin, normal +z, from a rectangle parallel to the plane with corner above
/// it. Source: [Howell2010] configuration factor C-11.
double corner_factor(double a, double b, double height) {
  const double A = a / height, B = b / height;
  const double ra = std::sqrt(1.0 + A * A), rb = std::sqrt(1.0 + B * B);
  return (A / ra * std::atan(B / ra) + B / rb * std::atan(A / rb)) / (2.0 * pi);
}

TEST(Lights, RectangleGivesTheIrradianceOfItsConfigurationFactor) {
  // Large and near, where it is sampled by solid angle, and small and far, where by area.
  for (const double size : {60.0, 1.0}) {
    Scene scene = white_square(size > 10.0 ? 1024 : 64);
    scene.film = {.width = 2, .height = 2};
    scene.lights = {RectangleLight{.center = {0, 0, 30},
                                   .edge_u = {0, size, 0},  // shines towards -z
                                   .edge_v = {size, 0, 0},
                                   .radiance = {5, 5, 5}}};
    const double expected = 5.0 * 4.0 * corner_factor(0.5 * size, 0.5 * size, 30.0);
    // 4096 samples whose radiance times cosine varies by less than 40 %: 0.6 % and less.
    EXPECT_NEAR(mean_of(render(scene).image, 0), expected, 0.008 * expected) << size;
  }
}

TEST(Lights, RectangleShinesOnlyForward) {
  Scene scene = white_square(4);
  scene.lights = {RectangleLight{
      .center = {0, 0, 30}, .edge_u = {60, 0, 0}, .edge_v = {0, 60, 0}, .radiance = {5, 5, 5}}};
  EXPECT_EQ(mean_of(render(scene).image, 0), 0.0);
}

/// A gradient sky with a small bright patch.
Image patchy_sky() {
  Image sky = make_image(32, 16, {"R", "G", "B"});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c)
        sky.at(x, y)[c] = 0.1f * static_cast<float>(16 - y) + (x == 20 && y == 4 ? 200.0f : 0.0f);
  return sky;
}

// Each way of drawing directions converges to the same image, so the weights add up to 1.
TEST(DirectLight, LightSurfaceAndCombinedSamplingAgree) {
  Scene scene = white_square(256);
  scene.materials[0].coat = Coat{.roughness = {.value = 0.3f}};
  scene.camera.position = {30, -40, 60};
  scene.camera.horizontal_fov = 0.2;
  scene.images = {patchy_sky()};
  scene.film = {.width = 16, .height = 16};
  const RectangleLight panel{
      .center = {-20, 30, 40}, .edge_u = {0, 40, 0}, .edge_v = {30, 0, -20}, .radiance = {2, 2, 2}};
  for (const bool with_panel : {false, true}) {
    scene.lights = {EnvironmentLight{.image = 0, .rotation = 0.4f}};
    if (with_panel) scene.lights.emplace_back(panel);
    using Direct = RenderOptions::DirectLight;
    const double combined = mean_of(render(scene, {.direct_light = Direct::combined}).image, 0);
    const double lights = mean_of(render(scene, {.direct_light = Direct::lights_only}).image, 0);
    const double surfaces =
        mean_of(render(scene, {.direct_light = Direct::surfaces_only}).image, 0);
    // 65536 samples: the patch makes surface sampling vary by ten times its mean, 4 % at 1 sigma
    // of the mean; the sky alone makes the others vary by about 1, 0.4 %.
    EXPECT_NEAR(lights, combined, 0.015 * combined) << with_panel;
    EXPECT_NEAR(surfaces, combined, 0.06 * combined) << with_panel;
    EXPECT_GT(combined, 0.1);
  }
}

// A convex body of reflectance 1 in even light cannot be told from the background.
TEST(Furnace, WhiteSphereVanishesInEvenLight) {
  Scene scene;
  scene.camera = camera_above(12.0);
  scene.film = {.width = 16, .height = 16};
  scene.render = {.samples_per_pixel = 16, .max_bounces = 2};
  scene.materials = {diffuse_material(1.0f)};
  scene.meshes = {make_sphere(5.0f)};
  scene.lights = {EnvironmentLight{}};
  const Image image = render(scene).image;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_NEAR(image.at(x, y)[0], 1.0f, 2e-4f) << x << ' ' << y;
}

// A coat over a white base: all light that enters leaves again, whatever the coat mirrors.
TEST(Furnace, CoatOverWhiteKeepsAllLightAndNeverAddsAny) {
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f}) {
    Scene scene;
    scene.camera = camera_above(12.0);
    scene.film = {.width = 16, .height = 16};
    scene.render = {.samples_per_pixel = 256, .max_bounces = 0};
    scene.materials = {diffuse_material(1.0f)};
    scene.materials[0].coat = Coat{.ior = 1.5f, .roughness = {.value = roughness}};
    scene.meshes = {make_sphere(5.0f)};
    scene.lights = {EnvironmentLight{}};
    const Image image = render(scene).image;
    // Within the noise of 65536 samples and the error of the table of the coat's reflectance.
    EXPECT_NEAR(mean_of(image, 0), 1.0, 4e-3) << roughness;
    float top = 0.0f;
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) top = std::max(top, image.at(x, y)[0]);
    EXPECT_LT(top, 1.15f) << roughness;  // noise of 256 samples at the grazing edge
  }
}

TEST(Furnace, GlassSphereLosesNoLight) {
  for (const float roughness : {0.0f, 0.2f}) {
    Scene scene;
    scene.camera = camera_above(12.0);
    scene.film = {.width = 16, .height = 16};
    scene.render = {.samples_per_pixel = 64, .max_bounces = 4};
    scene.materials = {
        {.name = "glass",
         .surface = DielectricSurface{.ior = 1.5f, .roughness = {.value = roughness}}}};
    scene.meshes = {make_sphere(5.0f)};
    scene.lights = {EnvironmentLight{}};
    // Smooth: only rays trapped for 48 reflections are lost. Rough: single scattering by facets
    // loses a few percent at each of two crossings.
    EXPECT_NEAR(mean_of(render(scene).image, 0), 1.0, roughness > 0.0f ? 0.04 : 2e-3);
  }
}

// A sun in a mirror below a white ball, and in a ball of glass above it: light that reaches the
// white surfaces by mirrors is found so seldom that it must not be counted in full.
TEST(Render, MirroredSunLeavesNoBrightSpecks) {
  Scene scene;
  scene.camera = {.position = {0, -30, 12}, .up = {0, 0, 1}, .horizontal_fov = 0.6};
  scene.film = {.width = 48, .height = 48};
  scene.render = {.samples_per_pixel = 16, .max_bounces = 3};
  SurfaceMaterial floor = diffuse_material(0.5f);
  floor.coat = Coat{.roughness = {.value = 0.0f}};
  scene.materials = {
      diffuse_material(0.8f), floor, {.name = "glass", .surface = DielectricSurface{.ior = 1.5f}}};
  scene.meshes = {make_sphere(4.0f), make_square(60.0f, 1), make_sphere(5.0f, 48, 2)};
  for (Vec3f& p : scene.meshes[1].positions) p.z -= 6.0f;
  Image sky = make_image(256, 128, {"R", "G", "B"});
  for (float& value : sky.pixels) value = 0.3f;
  for (int c = 0; c < 3; ++c) sky.at(200, 40)[c] = 6500.0f;
  scene.images = {sky};
  scene.lights = {EnvironmentLight{.image = 0}};
  const Image image = render(scene).image;
  for (int y = 1; y < 47; ++y)
    for (int x = 1; x < 47; ++x) {
      if (image.at(x, y)[6] > 0.3f * image.at(x, y)[0]) continue;  // the highlights themselves
      float around = 0.0f;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (i != 0 || j != 0) around = std::max(around, image.at(x + i, y + j)[0]);
      EXPECT_LT(image.at(x, y)[0], 4.0f * around) << x << ' ' << y;
    }
}

TEST(Render, SameImageForAnyNumberOfThreads) {
  Scene scene = white_square(8);
  scene.meshes.push_back(make_sphere(8.0f));
  scene.camera = camera_above(40.0);
  scene.film = {.width = 40, .height = 24};
  scene.images = {patchy_sky()};
  scene.lights = {EnvironmentLight{.image = 0}};
  scene.render.max_bounces = 3;
  set_thread_count(1);
  const Image one = render(scene).image;
  set_thread_count(3);
  const Image three = render(scene).image;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, three.pixels);
  scene.render.seed = 1;
  EXPECT_NE(render(scene).image.pixels, one.pixels);
}

TEST(Render, EarlyStopLeavesACompleteImage) {
  Scene scene = white_square(64);
  scene.film = {.width = 33, .height = 17};
  scene.lights = {EnvironmentLight{}};
  const RenderResult result = render(scene, {}, [](double finished) { return finished < 0.3; });
  EXPECT_FALSE(result.statistics.is_complete);
  EXPECT_LT(result.statistics.samples_per_pixel, 40.0);
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 33; ++x) EXPECT_NEAR(result.image.at(x, y)[0], 1.0f, 1e-4f);
}

// A pixel of a thin lens of diameter a focused at f sees a disc of diameter a |d - f| / f in the
// plane at distance d, so an edge there goes from dark to bright over that width.
TEST(Camera, DepthOfFieldBlursAnEdgeByTheCircleOfConfusion) {
  Scene scene = white_square(256);
  scene.meshes = {make_square(100.0f)};
  for (Vec3f& p : scene.meshes[0].positions) p.x += 50.0f;  // the edge runs along x = 0
  scene.camera = {.position = {0, 0, 100},
                  .horizontal_fov = 2.0 * std::atan(0.05),
                  .aperture_diameter = 4.0,
                  .focus_distance = 50.0};
  scene.film = {.width = 100, .height = 2};  // 0.1 mm per pixel at the square
  scene.lights = {DirectionalLight{.direction = {0, 0, 1}, .irradiance = {pi_f, pi_f, pi_f}}};
  const Image blurred = render(scene).image;
  int partial = 0;
  for (int x = 0; x < 100; ++x) {
    const float value = blurred.at(x, 0)[0];
    partial += value > 0.02f && value < 0.98f;
  }
  EXPECT_NEAR(0.1 * partial, 4.0, 0.4);  // a |d - f| / f = 4 mm; the last 2 % of a disc are thin
  scene.camera.focus_distance = 100.0;
  const Image sharp = render(scene).image;
  EXPECT_LT(sharp.at(48, 0)[0], 0.01f);
  EXPECT_GT(sharp.at(51, 0)[0], 0.99f);
}

TEST(Render, RefusesScenesThatMakeNoSense) {
  Scene scene = white_square(1);
  scene.film.width = 0;
  EXPECT_THROW((void)render(scene), InvalidInput);
  scene = white_square(1);
  scene.camera.look_at = scene.camera.position;
  EXPECT_THROW((void)render(scene), InvalidInput);
  scene = white_square(1);
  scene.meshes[0].material[0] = 7;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

TEST(Render, EmptySceneShowsTheBackground) {
  Scene scene = white_square(1);
  scene.meshes.clear();
  scene.lights = {EnvironmentLight{.scale = {1, 2, 3}}};
  EXPECT_NEAR(mean_of(render(scene).image, 2), 3.0, 1e-5);
  scene.lights = {EnvironmentLight{.is_visible = false}};
  EXPECT_EQ(mean_of(render(scene).image, 2), 0.0);
}

}  // namespace
}  // namespace lamina
