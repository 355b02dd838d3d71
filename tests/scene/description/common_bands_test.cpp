// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/description/common_bands.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "lamina/solve/reflectance/material_totals.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using Method = RenderSettings::Method;

SurfaceMaterial translucent(const std::string& name) {
  return {.name = name, .surface = SubsurfaceSurface{.material = find_material(name)}};
}

/// A ball of a material in even light and, if there is another one, a ball of that far away.
Scene scene_of(const std::string& name, const std::string& other, Method method) {
  Scene scene;
  scene.camera = camera_above(20.0);
  scene.film = {.width = 16, .height = 16};
  scene.render = {.method = method, .profile = quick_profile(method), .samples_per_pixel = 16};
  scene.render.max_bounces = 0;
  scene.render.hierarchy = {.spacing = 0.6f, .irradiance_samples = 2};
  scene.materials = {translucent(name)};
  scene.meshes = {make_sphere(10.0f, 32)};
  scene.meshes[0].is_closed = true;
  scene.lights = {EnvironmentLight{}};
  if (other.empty()) return scene;
  scene.materials.push_back(translucent(other));
  Mesh far = make_sphere(1.0f, 8, 1);
  for (Vec3f& position : far.positions) position += Vec3f{200, 0, 0};
  far.is_closed = true;
  scene.meshes.push_back(far);
  return scene;
}

/// Mean color of what leaves the inside of a ball that touches the borders of the picture.
Vec3 color_of(const Image& image) {
  Vec3 color;
  for (int c = 0; c < 3; ++c)
    color[c] = mean_of(image, *channel_index(image, std::string("subsurface.") + "RGB"[c])) * 4.0 /
               std::numbers::pi;
  return color;
}

// An ear-ring of jade on skin by wavelengths has the color that it has alone, in RGB.
TEST(CommonBands, RgbMaterialBesideSkinKeepsItsColor) {
  for (const Method method : {Method::hierarchy, Method::random_walk}) {
    const Vec3 alone = color_of(render(scene_of("jade", "", method)).image);
    Scene mixed = scene_of("jade", "skin_type_3", method);
    make_bands_common(mixed);
    ASSERT_EQ(mixed.band_changes.size(), 1u);
    EXPECT_EQ(mixed.band_changes[0].material, 0u);
    EXPECT_TRUE(mixed.band_changes[0].from.is_rgb());
    const double error = mixed.band_changes[0].color_error;
    EXPECT_LT(error, 0.005);
    const Vec3 beside = color_of(render(mixed).image);
    const double noise = method == Method::random_walk ? 0.004 : 0.0;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(beside[c], alone[c], error + noise) << c;
  }
}

// Whatever the material, in total: by adding-doubling at the wavelengths, turned into a color.
TEST(CommonBands, ThickRgbMaterialsKeepTheColorOfTheirReflectance) {
  for (const char* name : {"marble", "jensen_skin1", "jensen_chicken1", "jensen_ketchup"})
    for (const char* other : {"skin_type_3", "green_leaf"}) {
      Scene scene;
      scene.materials = {translucent(name), translucent(other)};
      const std::vector<EnteredTotals> rgb = material_totals(layer_stacks(find_material(name)));
      make_bands_common(scene);
      const Material& converted = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
      EXPECT_EQ(converted.bands, find_material(other).bands);
      std::vector<double> spectrum;
      for (const EnteredTotals& totals : material_totals(layer_stacks(converted)))
        spectrum.push_back(totals.reflectance);
      const LinearSrgb color = linear_srgb(weights_of_bands(scene, converted.bands), spectrum);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(color[c], rgb[c].reflectance, 0.005) << name << " beside " << other;
    }
}

TEST(CommonBands, WhiteStaysWhite) {
  Scene scene;
  scene.materials = {
      {.name = "white",
       .surface = SubsurfaceSurface{.material = half_space({0.0, 0.0, 0.0}, 2.0, 1.3)}},
      translucent("skin_type_3")};
  make_bands_common(scene);
  const Material& white = std::get<SubsurfaceSurface>(scene.materials[0].surface).material;
  for (const double sigma_a : white.layers[0].sigma_a) EXPECT_EQ(sigma_a, 0.0);
  for (const double sigma_s : white.layers[0].sigma_s) EXPECT_NEAR(sigma_s, 2.0, 1e-9);
}

TEST(CommonBands, SkinIsMadeAnewAndOtherMaterialsAreInterpolated) {
  const auto material = [](const std::string& inside) {
    return parse_material(
        R"({"lamina": "material", "version": 1, "length_unit": "mm", )" + inside + "}", "test");
  };
  Scene scene;
  scene.materials = {
      translucent("skin_type_3"),
      {.name = "coarse",
       .surface = SubsurfaceSurface{.material = material(R"("bands": [450, 640], "skin": {})")}},
      {.name = "wax",
       .surface = SubsurfaceSurface{
           .material = material(R"("bands": [470, 610], "layers": [{"sigma_a": [0.4, 0.1],
             "sigma_s": [3, 2], "g": [0.1, 0.2], "ior": 1.4, "thickness": "infinite"}])")}}};
  make_bands_common(scene);
  ASSERT_EQ(scene.band_changes.size(), 2u);
  const auto& skin = std::get<SubsurfaceSurface>(scene.materials[1].surface).material;
  const auto wavelengths = default_spectral_bands();
  EXPECT_EQ(skin.layers, skin_layers(skin.skin->skin, wavelengths.wavelengths()));
  EXPECT_EQ(skin.bands, wavelengths);
  const auto& wax = std::get<SubsurfaceSurface>(scene.materials[2].surface).material;
  EXPECT_NEAR(wax.layers[0].sigma_a[0], 0.4, 1e-12);  // 400 nm, beyond the first
  EXPECT_NEAR(wax.layers[0].sigma_a[2], 0.4, 1e-12);  // 470 nm
  EXPECT_NEAR(wax.layers[0].sigma_a[4], 0.2, 1e-12);  // 540 nm, in the middle
  EXPECT_NEAR(wax.layers[0].g[4], 0.15, 1e-12);
  EXPECT_NEAR(wax.layers[0].sigma_s[7], 2.0, 1e-12);  // 645 nm, beyond the last
  EXPECT_GT(scene.band_changes[1].color_error, 0.0);
}

// What `lamina render` prints.
TEST(CommonBands, LoadingASceneSaysWhatBecameOfEachMaterial) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "common_bands";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scene.json") << R"({"lamina": "scene", "version": 1, "mm_per_unit": 1,
    "camera": {"position": [0, 0, 9], "look_at": [0, 0, 0]},
    "materials": {"ring": {"subsurface": "jade"}, "ear": {"subsurface": "skin_type_3"},
                  "card": {"thin": "paper"}},
    "meshes": [{"shape": "sphere", "material": "ear"}, {"shape": "sphere", "material": "ring"},
               {"shape": "rectangle", "width": 1, "height": 1, "material": "card"}],
    "lights": [{"type": "environment", "radiance": 1}]})";
  const Scene scene = load_scene(folder / "scene.json");
  ASSERT_EQ(scene.warnings.size(), scene.band_changes.size());
  EXPECT_TRUE(scene.warnings[0].starts_with(
      "material \"ring\": RGB turned into the 8 wavelengths of the scene; colors differ by up to "))
      << scene.warnings[0];
  EXPECT_EQ(bands_of(scene), default_spectral_bands());
}

}  // namespace
}  // namespace lamina
