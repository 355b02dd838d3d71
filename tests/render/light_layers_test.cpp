// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/light_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

/// A ball of wax-like stuff on a floor, a lamp of a shining square, a sky and two rectangles.
Scene scene_of_lights() {
  Scene scene;
  SurfaceMaterial ball{.name = "ball"};
  ball.surface = SubsurfaceSurface{.material = half_space({0.01, 0.03, 0.1}, 1.0, 1.4),
                                   .thickness = {.value = 0}};
  scene.materials = {
      ball,
      {.name = "floor", .surface = DiffuseSurface{.color = {.value = {0.6f, 0.5f, 0.4f}}}},
      {.name = "red lamp", .surface = DiffuseSurface{}, .emission = {6, 1, 1}}};
  Mesh sphere = make_sphere(5.0f, 24);
  sphere.is_closed = true;
  Mesh floor = make_square(60.0f, 1), lamp = make_square(4.0f, 2);
  for (Vec3f& p : floor.positions) p = p - Vec3f{0, 0, 6};
  for (Vec3f& p : lamp.positions) p = {12.0f - p.z, p.y, 4.0f + p.x};
  for (Vec3f& n : lamp.normals) n = {-1, 0, 0};
  scene.meshes = {sphere, floor, lamp};
  const RectangleLight key{
      .center = {-15, 0, 20}, .edge_u = {0, 6, 0}, .edge_v = {6, 0, 0}, .radiance = {9, 9, 8}};
  RectangleLight rim = key;
  rim.center = {10, 12, 18};
  rim.radiance = {2, 4, 6};
  scene.lights = {key, EnvironmentLight{.scale = {0.1f, 0.12f, 0.2f}}, rim,
                  PointLight{.position = {0, -20, 15}, .intensity = {300, 200, 100}}};
  scene.light_names = {"key", "", "key", ""};
  scene.camera = {
      .position = {0, -30, 25}, .look_at = {0, 0, 0}, .up = {0, 0, 1}, .horizontal_fov = 0.6};
  scene.film.width = 24;
  scene.film.height = 20;
  scene.render.samples_per_pixel = 8;
  scene.render.profile = RenderSettings::Profile::diffusion;
  return scene;
}

std::vector<float> colors(const Image& image, const std::string& layer) {
  return select_channels(image, {layer + "R", layer + "G", layer + "B"}).pixels;
}

TEST(LightLayers, AreCalledByNameOrKindAndShareTheirName) {
  const std::vector<LightGroup> groups = light_groups(scene_of_lights());
  ASSERT_EQ(groups.size(), 4U);
  EXPECT_EQ(groups[0].name, "key");
  EXPECT_EQ(groups[0].lights, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(groups[1].name, "environment");
  EXPECT_EQ(groups[2].name, "point");
  EXPECT_EQ(groups[3].name, "red_lamp");
  EXPECT_EQ(groups[3].materials, std::vector<std::uint32_t>{2});
  Scene unnamed = scene_of_lights();
  unnamed.light_names.clear();
  EXPECT_EQ(light_groups(unnamed)[0].name, "rectangle_1");
  EXPECT_EQ(light_groups(unnamed)[2].name, "rectangle_2");
}

/// Each layer against the scene that has its lights alone, and their sum against the picture.
void expect_layers(Scene scene) {
  const RenderResult layered = render_light_layers(scene);
  const std::vector<float> sum = colors(layered.image, "");
  std::vector<double> added(sum.size());
  const auto add = [&](const std::string& name) {
    const std::vector<float> layer = colors(layered.image, "light." + name + ".");
    for (std::size_t i = 0; i < added.size(); ++i) added[i] += static_cast<double>(layer[i]);
    return layer;
  };
  Scene key = scene, sky = scene, point = scene, lamp = scene;
  for (Scene* one : {&key, &sky, &point}) one->materials[2].emission = {};
  key.lights = {scene.lights[0], scene.lights[2]};
  sky.lights = {scene.lights[1]};
  point.lights = {scene.lights[3]};
  lamp.lights = {};
  EXPECT_EQ(add("key"), colors(render(key).image, ""));
  EXPECT_EQ(add("environment"), colors(render(sky).image, ""));
  EXPECT_EQ(add("point"), colors(render(point).image, ""));
  EXPECT_EQ(add("red_lamp"), colors(render(lamp).image, ""));
  for (std::size_t i = 0; i < sum.size(); ++i)
    EXPECT_NEAR(sum[i], added[i], 4e-7 * added[i] + 1e-12);
}

TEST(LightLayers, EachIsThePictureOfItsLightsAloneAndTheirSumIsThePicture) {
  for (const char* method : {"probe", "random_walk", "hierarchy", "shadow_map"}) {
    SCOPED_TRACE(method);
    Scene scene = scene_of_lights();
    scene.render.method = *find_method(method);
    if (std::string(method) == "random_walk") scene.render.profile.reset();
    expect_layers(std::move(scene));
  }
}

// Light is linear: the sum of the layers is the picture of all lights, up to noise. The mean over
// all pixels, within four standard errors of the two.
TEST(LightLayers, SumHasTheMeanOfThePictureOfAllLights) {
  Scene scene = scene_of_lights();
  scene.render.method = *find_method("probe");
  scene.render.samples_per_pixel = 64;
  const Image layered = render_light_layers(scene).image;
  scene.render.seed = 9;
  const Image whole = render(scene).image;
  const auto mean_and_variance = [](const Image& image) {
    const std::vector<float> c = colors(image, "");
    const std::vector<float> v = select_channels(image, {"variance"}).pixels;
    double mean = 0.0, variance = 0.0;
    const auto n = static_cast<double>(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
      mean += (0.2126 * c[3 * i] + 0.7152 * c[3 * i + 1] + 0.0722 * c[3 * i + 2]) / n;
      variance += static_cast<double>(v[i]) / (n * n);
    }
    return std::pair(mean, variance);
  };
  const auto [mean, variance] = mean_and_variance(layered);
  const auto [wanted, wanted_variance] = mean_and_variance(whole);
  const double error = std::sqrt(variance + wanted_variance);
  EXPECT_NEAR(mean, wanted, 4.0 * error);
  EXPECT_LT(error, 0.01 * wanted);  // so that noise cannot hide a light that is missing
}

TEST(LightLayers, SceneIsAsItWasAndOtherChannelsAreThoseOfThePicture) {
  Scene scene = scene_of_lights();
  scene.film.has_alpha = true;
  const Image layered = render_light_layers(scene, {.has_mattes = true}).image;
  EXPECT_EQ(scene.lights.size(), 4U);
  EXPECT_EQ(scene.materials[2].emission.x, 6.0f);
  EXPECT_TRUE(scene.render.method.is_open());
  const Image whole = render(scene, {.has_mattes = true}).image;
  for (const std::string name :
       {"A", "normal.X", "albedo.G", "depth.Z", "samples", "CryptoObject00.R"})
    EXPECT_EQ(select_channels(layered, {name}).pixels, select_channels(whole, {name}).pixels)
        << name;
}

TEST(LightLayers, WhatTheyDoNotGoWithIsRefused) {
  const auto refusal = [](Scene scene, const RenderOptions& options) -> std::string {
    try {
      (void)render_light_layers(scene, options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "rendered";
  };
  const Scene scene = scene_of_lights();
  EXPECT_EQ(refusal(scene, {.cache = "x.ply"}),
            "light layers: do not go with a cache of the light");
  EXPECT_EQ(refusal(scene, {.resumes = true}),
            "light layers: do not go with going on with a picture");
  Scene dark = scene;
  dark.lights.clear();
  dark.materials[2].emission = {};
  EXPECT_EQ(refusal(dark, {}), "light layers: the scene must have a light, but has none");
  Scene many = scene;
  many.light_names.clear();
  many.lights.assign(70, scene.lights[3]);
  EXPECT_EQ(refusal(many, {}),
            "light layers: there can be at most 64, but the scene has 71; lights of the same "
            "\"name\" share one");
}

}  // namespace
}  // namespace lamina
