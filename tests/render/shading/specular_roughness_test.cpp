// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {Method::probe, Method::hierarchy, Method::random_walk,
                                          Method::layered_bsdf};
  return all;
}

Material skin(const std::string& surface = "") {
  return parse_material(
      R"({"lamina": "material", "version": 1, "length_unit": "mm", "bands": [450, 540, 640], )" +
          surface + R"("skin": {}})",
      "skin");
}

/// A ball of skin of 8 mm.
Scene ball(Method method, Material material, Light light) {
  Scene scene = translucent_scene(method, make_sphere(8.0f), std::move(material), std::move(light));
  scene.meshes.front().is_closed = true;
  scene.camera = camera_above(17.0);
  scene.film = {.width = 24, .height = 24};
  scene.render.samples_per_pixel = 16;
  scene.render.max_bounces = 1;
  scene.render.hierarchy = {.spacing = 0.8f, .irradiance_samples = 16};
  return scene;
}

/// The brightest pixel over the mean of all, in green.
double contrast(const Image& image) {
  float most = 0.0f;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) most = std::max(most, image.at(x, y)[1]);
  return static_cast<double>(most) / mean_of(image, 1);
}

TEST(SpecularRoughness, SkinShowsNoImagesOfLamps) {
  const RectangleLight lamp{.center = {-12, 10, 25},
                            .edge_u = {0, 10, 0},
                            .edge_v = {10, 0, 0},
                            .radiance = {40, 40, 40}};
  for (const Method method : methods()) {
    const Image rough = render(ball(method, skin(), lamp)).image;
    const Image smooth = render(ball(method, skin(R"("surface": {"roughness": 0}, )"), lamp)).image;
    EXPECT_GT(contrast(smooth), 1.5 * contrast(rough)) << method.name();  // 2 to 4, 1.98 with noise
  }
}

// Light that the rough mirror does not send back enters, and leaves again where nothing absorbs.
TEST(SpecularRoughness, WhiteLayersSendBackAsMuchAsUnderASmoothSurface) {
  const auto mean = [](Method method, std::optional<double> specular_roughness) {
    Material white = half_space({1e-5, 1e-5, 1e-5}, 4.0, 1.4);
    white.specular_roughness = specular_roughness;
    Scene scene = translucent_scene(method, make_square(40.0f), white, EnvironmentLight{});
    scene.render.max_bounces = 1;
    scene.render.samples_per_pixel = 512;
    scene.render.hierarchy = {.spacing = 0.4f, .irradiance_samples = 16};
    return mean_of(render(scene).image, 1);
  };
  for (const Method method : {Method::probe, Method::hierarchy, Method::layered_bsdf}) {
    const double smooth = mean(method, std::nullopt);
    // A BSDF of layers under a rough surface takes the smooth one's share of each direction.
    const double tolerance = method == Method::layered_bsdf ? 0.03 : 0.003;
    EXPECT_NEAR(mean(method, skin_specular_roughness), smooth, tolerance) << method.name();
    EXPECT_NEAR(smooth, 1.0, 0.05) << method.name();  // profiles are by diffusion
  }
}

TEST(SpecularRoughness, IsReadAndWritten) {
  const Material plain = skin();
  EXPECT_EQ(plain.specular_roughness, skin_specular_roughness);
  EXPECT_EQ(plain.layers.front().top.roughness, 0.0);
  EXPECT_EQ(specular_top(plain).roughness, skin_specular_roughness);
  EXPECT_EQ(parse_material(format_material(plain), "again").specular_roughness,
            skin_specular_roughness);

  const Material given = skin(R"("surface": {"roughness": 0.1, "specular_roughness": 0.2}, )");
  EXPECT_EQ(given.layers.front().top.roughness, 0.1);
  EXPECT_EQ(specular_top(given).roughness, 0.2);
  EXPECT_EQ(skin(R"("surface": {"roughness": 0.1}, )").specular_roughness, std::nullopt);
  EXPECT_EQ(find_material("skin_type_4").specular_roughness, skin_specular_roughness);
  EXPECT_EQ(find_material("jade").specular_roughness, std::nullopt);
}

}  // namespace
}  // namespace lamina
