// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/correction/corrected_transport.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/parallel.h"
#include "lamina/base/image/image.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// A ball of skin1 of 10 mm in light of radiance 1 all around, over the flat profile.
Scene ball_to_correct(double density) {
  Material skin = find_material("jensen_skin1");
  MaterialLayer& layer = skin.layers[0];
  layer.ior = skin.ior_below = {1.33, 1.33, 1.33};
  for (double& sigma : layer.sigma_a) sigma *= density;
  for (double& sigma : layer.sigma_s) sigma *= density;
  Scene scene;
  scene.camera = camera_above(20.0);
  scene.film = {.width = 64, .height = 64};
  scene.render.method = RenderSettings::Method::hierarchy;
  scene.render.profile = RenderSettings::Profile::diffusion;
  scene.render.is_corrected = true;
  scene.render.samples_per_pixel = 4;
  scene.materials = {{.name = "skin", .surface = SubsurfaceSurface{.material = std::move(skin)}}};
  scene.meshes = {make_sphere(10.0f, 96)};
  scene.meshes[0].is_closed = true;
  scene.lights = {EnvironmentLight{}};
  return scene;
}

// What photons one by one find (random_walk_test.cpp). The flat profile has .50 .23 .12 and is off
// by up to a tenth. The walks of a picture of this size know the mean to .3 %.
TEST(CorrectedTransport, BallOfSkinHasTheAlbedoOfPhotons) {
  const double expected[2][3] = {{0.5447, 0.2399, 0.1220}, {0.4258, 0.2061, 0.1115}};
  for (int dense = 0; dense < 2; ++dense) {
    Scene scene = ball_to_correct(dense == 0 ? 1.0 : 10.0);
    scene.film = {.width = 128, .height = 128};
    const RenderResult result = render(scene);
    const char* names[] = {"subsurface.R", "subsurface.G", "subsurface.B"};
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(4.0 / std::numbers::pi *
                      mean_of(result.image, channel_index(result.image, names[c]).value()),
                  expected[dense][c], 0.01 * expected[dense][c])
          << dense << ' ' << c;
    ASSERT_EQ(result.statistics.corrections.size(), 1u);
    EXPECT_GT(result.statistics.corrections[0].walks, 10'000u);
    EXPECT_LT(result.statistics.corrections[0].error_left, 0.1);
  }
}

// Light that is kept without a correction gets one, beside it; then nothing is made anew.
TEST(CorrectedTransport, IsKeptWithTheLight) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 8, .height = 8};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 2};
  RenderOptions options{.cache = std::filesystem::path(testing::TempDir()) / "correction.ply"};
  std::filesystem::remove(options.cache);
  scene.render.is_corrected = false;
  const Image planar = render(scene, options).image;
  scene.render.is_corrected = true;
  std::vector<std::string> notices;
  options.on_notice = [&](const std::string& line) {
    if (line.find("anew") != std::string::npos) notices.push_back(line);
  };
  const RenderResult made = render(scene, options);
  EXPECT_EQ(notices.size(), 1u);
  options.needs_cache = true;
  const RenderResult kept = render(scene, options);
  EXPECT_EQ(notices.size(), 1u);
  EXPECT_EQ(made.image.pixels, kept.image.pixels);
  EXPECT_EQ(made.statistics.corrections[0].walks, kept.statistics.corrections[0].walks);
  scene.render.is_corrected = false;
  EXPECT_EQ(render(scene, options).image.pixels, planar.pixels);
}

/// Of a ball in which light hardly gets round, in light of radiance 1 all around.
void expect_flat_reflectance(const Scene& scene, double error) {
  const Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  const Image image = render(scene).image;
  const char* names[] = {"subsurface.R", "subsurface.G", "subsurface.B"};
  for (std::size_t c = 0; c < 3; ++c) {
    const double flat =
        adding_doubling(layer_stack(skin, c), {.is_diffuse = true}, {.accuracy = 1e-4})
            .totals.diffuse_reflectance;
    EXPECT_NEAR(4.0 / std::numbers::pi * mean_of(image, channel_index(image, names[c]).value()),
                flat, error * flat)
        << c;
  }
}

// Walks take a rough boundary as smooth, and flat layers make up for it: by them the ball, in which
// light hardly gets round, reflects 5 to 9 % more than under a smooth one.
TEST(CorrectedTransport, HasTheLightOfRoughBoundaries) {
  Scene scene = ball_to_correct(20.0);
  Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  skin.layers[0].top.roughness = 0.4;
  expect_flat_reflectance(scene, 0.02);
}

// Walks through maps take light as scattered evenly after some events, in layers of one index. If
// all of it were, the ball, in which light hardly gets round, would be up to 15 % brighter.
TEST(CorrectedTransport, HasTheLightOfMapsThatScatterForward) {
  Scene scene = ball_to_correct(1.0);
  Material& skin = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  skin = material_of({layer_of({0.45, 1.16, 3.16}, {14.2, 17.3, 27.0}, 0.77, 0.25),
                      layer_of({0.01, 0.1, 1.18}, {7.1, 8.7, 13.5}, 0.77, infinite)});
  skin.layers[1].ior = skin.ior_below = {1.38, 1.38, 1.38};
  MaterialMap thickness{{.of = MappableNumber::Of::thickness, .layer = 0}, make_image(4, 2, {"Y"})};
  for (float& value : thickness.values.pixels) value = 0.25f;
  std::get<SubsurfaceSurface>(scene.materials[0].surface).material_maps = {thickness};
  scene.render.method = RenderSettings::Method::texture_space;
  scene.render.profile.reset();
  scene.meshes = {make_sphere(60.0f, 96)};
  scene.meshes[0].is_closed = true;
  scene.camera = camera_above(120.0);
  expect_flat_reflectance(scene, 0.035);
}

// Whoever computes it, and however many.
TEST(CorrectedTransport, IsTheSameByAnyNumberOfThreads) {
  Scene scene = ball_to_correct(1.0);
  scene.film = {.width = 8, .height = 8};
  scene.render.hierarchy = {.spacing = 1.0f, .irradiance_samples = 2};
  const Image many = render(scene).image;
  set_thread_count(1);
  const Image one = render(scene).image;
  set_thread_count(0);
  EXPECT_EQ(one.pixels, many.pixels);
}

TEST(CorrectedTransport, RefusesWhatRandomWalksCannotFollow) {
  Scene scene = ball_to_correct(1.0);
  scene.meshes[0].is_closed = false;
  try {
    (void)render(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("render.correct: "), std::string::npos)
        << error.what();
  }
  scene = ball_to_correct(1.0);
  scene.render.single_scattering = RenderSettings::SingleScattering::straight;
  EXPECT_THROW((void)render(scene), InvalidInput);
  scene = ball_to_correct(1.0);
  scene.render.method = RenderSettings::Method::probe;
  EXPECT_THROW((void)render(scene), InvalidInput);
}

}  // namespace
}  // namespace lamina
