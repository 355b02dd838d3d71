// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/scene/description/method_settings.h"
#include "lamina/scene/description/subsurface_methods.h"
#include "render/small_scenes.h"

namespace lamina {
namespace {

using ColorUse = SubsurfaceSurface::ColorUse;
using Method = RenderSettings::Method;
using Single = RenderSettings::SingleScattering;

SubsurfaceSurface& surface_of(Scene& scene) {
  return std::get<SubsurfaceSurface>(scene.materials[0].surface);
}

/// Narrow stripes, of which white is four times the mean.
Image stripes() {
  Image image{.width = 32, .height = 1, .channels = {"R", "G", "B"}, .pixels = {}};
  for (int x = 0; x < image.width; ++x)
    image.pixels.insert(image.pixels.end(), 3, x % 5 == 0 ? 1.0f : 0.05f);
  return image;
}

/// White, nearly twice the mean, where it is looked up.
Image half_white() {
  Image image{.width = 32, .height = 1, .channels = {"R", "G", "B"}, .pixels = {}};
  for (int x = 0; x < image.width; ++x)
    image.pixels.insert(image.pixels.end(), 3, x < 16 ? 1.0f : 0.05f);
  return image;
}

constexpr std::size_t fine = 0, wide = 1;  // images

TextureMap map_of(std::size_t image) {
  const float repeat = image == fine ? 2.0f : 0.45f;
  return {.source = ImageMap{.image = image,
                             .placement = {.u_axis = {repeat, 0}, .v_axis = {0, repeat}}}};
}

/// What is asked for beside the material itself.
struct Look {
  std::string name;
  std::function<void(Scene&)> set;
};

const std::vector<Look>& looks() {
  static const auto color = [](ColorUse use, std::size_t image) {
    return [use, image](Scene& scene) {
      surface_of(scene).color_use = use;
      surface_of(scene).color.map = map_of(image);
    };
  };
  static const auto single = [](Single way) {
    return [way](Scene& scene) { scene.render.single_scattering = way; };
  };
  static const std::vector<Look> all = {
      {"plain", [](Scene&) {}},
      {"fine color that scales", color(ColorUse::scale, fine)},
      {"wide color that scales", color(ColorUse::scale, wide)},
      {"fine color that is inverted", color(ColorUse::invert, fine)},
      {"wide color that is inverted", color(ColorUse::invert, wide)},
      {"white that is inverted",
       [](Scene& scene) { surface_of(scene).color_use = ColorUse::invert; }},
      {"scattered once, straight", single(Single::straight)},
      {"scattered once, refracted", single(Single::refracted)},
      {"scattered once, color that scales",
       [](Scene& scene) {
         single(Single::refracted)(scene);
         color(ColorUse::scale, wide)(scene);
       }},
      {"scattered once, blurred, color that is inverted",
       [](Scene& scene) {
         single(Single::straight)(scene);
         color(ColorUse::invert, wide)(scene);
         surface_of(scene).single_scattering_blur.value = 0.2f;
       }},
      {"thickness by a map",
       [](Scene& scene) { surface_of(scene).thickness = {.value = 3.0f, .map = map_of(wide)}; }},
      {"absorption by a map",
       [](Scene& scene) {
         surface_of(scene).maps = {{.quantity = LayerMap::Quantity::sigma_a,
                                    .terms = {{.value = 1.0f, .map = map_of(fine)}}}};
       }},
      {"printed exit angle",
       [](Scene& scene) { scene.render.exit_angle = RenderSettings::ExitAngle::printed; }},
      {"dipole", [](Scene& scene) { scene.render.profile = RenderSettings::Profile::dipole; }},
  };
  return all;
}

/// In even light from everywhere, which a body that neither absorbs nor makes light does not
/// change.
Scene furnace(Method method, Mesh mesh, Material material, double size) {
  Scene scene = translucent_scene(method, std::move(mesh), std::move(material), EnvironmentLight{});
  scene.images = {stripes(), half_white()};
  scene.camera = camera_above(size);
  scene.film = {.width = 8, .height = 8};
  scene.render.samples_per_pixel = method == Method::random_walk ? 128 : 32;
  scene.render.hierarchy = {.spacing = 0.4f, .irradiance_samples = 4};
  scene.render.shadow_map = {.resolution = 64, .dome_views = 32, .lookups = 4};
  return scene;
}

/// The largest mean over a quarter of the picture in any band.
double brightest_quarter(const Image& image) {
  double most = 0.0;
  for (const int x0 : {0, image.width / 2})
    for (const int y0 : {0, image.height / 2})
      for (std::size_t c = 0; c < 3; ++c) {
        double total = 0.0;
        for (int y = y0; y < y0 + image.height / 2; ++y)
          for (int x = x0; x < x0 + image.width / 2; ++x)
            total += static_cast<double>(image.at(x, y)[c]);
        most = std::max(most, 4.0 * total / (image.width * image.height));
      }
  return most;
}

/// How bright each look is that a method honours; its name tells which was brightest.
std::map<std::string, double> brightness_of_looks(Method method, const Mesh& mesh, double size) {
  std::map<std::string, double> found;
  // White under a boundary, white without one, and a color that a bright map more than fills.
  const std::vector<std::pair<std::string, Material>> materials = {
      {"white, index 1.4", half_space({1e-5, 1e-5, 1e-5}, 4.0, 1.4)},
      {"white, index 1", half_space({1e-5, 1e-5, 1e-5}, 4.0, 1.0)},
      {"marble", half_space({0.003, 0.03, 0.3}, 3.0, 1.5)}};
  for (const auto& [name, material] : materials)
    for (const Look& look : looks()) {
      Scene scene = furnace(method, mesh, material, size);
      look.set(scene);
      if (refusal(scene, method)) continue;
      // Walks in white are long, and plates without sides lose those that come to them.
      const bool is_white = name != "marble" || look.name.starts_with("white");
      if (method == Method::random_walk && is_white) continue;
      found[look.name + " of " + name] = brightest_quarter(render(scene).image);
    }
  return found;
}

// No texture, map or light scattered once makes a flat surface send back more than it gets.
TEST(Furnace, NoFlatMaterialReflectsMoreThanItGetsByAnyMethod) {
  std::map<std::string, std::size_t> counts;
  for (const Method method : subsurface_methods()) {
    if (method == Method::texture_space) continue;  // takes skin only, below
    const auto found = brightness_of_looks(
        method, method == Method::random_walk ? make_plate(40.0f, 20.0f) : make_square(40.0f), 3.0);
    counts[std::string(method.name())] = found.size();
    // Noise of a quarter: 1 %, of random walks 3 %.
    const double most = method == Method::random_walk ? 1.03 : 1.01;
    for (const auto& [name, brightness] : found)
      EXPECT_LT(brightness, most) << name << " by " << method.name();
  }
  EXPECT_EQ(counts["probe"], 39u);  // 13 looks of 3 materials: all but maps of layers
  EXPECT_EQ(counts["hierarchy"], 39u);
  EXPECT_EQ(counts["shadow_map"], 39u);
  EXPECT_EQ(counts["layered_bsdf"], 12u);  // plain, two colors that scale, a map
  EXPECT_EQ(counts["random_walk"], 5u);    // plain and four colors of marble
}

MappableNumber melanin_of_skin() {
  const auto& ranges = skin_parameter_ranges();
  std::size_t part = 0;
  while (ranges[part].name != "melanin") ++part;
  return {.of = MappableNumber::Of::skin, .part = part, .name = "skin.melanin", .high = 1.0};
}

// Recipes of which a number is a map, by the methods that take them.
TEST(Furnace, NoSkinOfMapsReflectsMoreThanItGets) {
  const Material skin = parse_material(
      R"({"lamina": "material", "version": 1, "length_unit": "mm", "bands": [450, 540, 640],
          "skin": {"melanin": 0, "hemoglobin_dermis": 0}})",
      "skin");
  std::size_t count = 0;
  for (const Method method : subsurface_methods()) {
    if (method == Method::random_walk) continue;  // walk_maps_test.cpp
    Scene scene = furnace(method, make_square(30.0f), skin, 3.0);
    scene.render.texture_space.irradiance_samples = 8;
    Image melanin = stripes();
    melanin.channels = {"Y"};
    melanin.pixels.resize(32);
    for (float& value : melanin.pixels) value *= 0.01f;
    surface_of(scene).material_maps = {{.number = melanin_of_skin(), .values = melanin}};
    if (refusal(scene, method)) continue;
    ++count;
    EXPECT_LT(brightest_quarter(render(scene).image), 1.0) << method.name();
  }
  EXPECT_EQ(count, 2u);  // texture_space and layered_bsdf
}

}  // namespace
}  // namespace lamina
