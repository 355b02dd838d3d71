// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/surface_skin_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lamina/render/skin_colors.h"
#include "lamina/scattering/adding_doubling.h"
#include "small_scenes.h"

namespace lamina {
namespace {

SurfaceMapRecipe recipe_on_a_sphere() {
  SurfaceMapRecipe recipe{.width = 256, .height = 128, .seed = 5};
  recipe.meshes = {make_sphere(20.0f, 32)};
  recipe.base.skin.melanin = 0.01;
  return recipe;
}

const SkinMap* find_map(const std::vector<SkinMap>& maps, std::string_view name) {
  for (const SkinMap& map : maps)
    if (map.name == name) return &map;
  return nullptr;
}

// Blood around a point on the equator, whatever the texture does there.
TEST(SurfaceSkinMaps, FlushesLieAroundTheirPlaceInSpace) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  SurfacePlaces where;
  where.places = {{{0, 20, 0}, 8.0f}};
  recipe.features = {{Flush{.hemoglobin_dermis = 0.02}, where}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  ASSERT_EQ(maps.size(), 1u);
  const Image& blood = find_map(maps, "hemoglobin_dermis")->values;
  const auto base = static_cast<float>(recipe.base.skin.hemoglobin_dermis);
  EXPECT_NEAR(*blood.at(64, 64), base + 0.02f, 1e-3f);  // a quarter round, on the equator
  const double angle = 2.0 * std::numbers::pi * (64 + 13.5 - 64) / 256.0;
  const double t = 1.0 - 2.0 * 20.0 * std::sin(0.5 * angle) / 8.0;
  EXPECT_NEAR(*blood.at(64 + 13, 64), base + 0.02 * t * t * (3.0 - 2.0 * t), 2e-4);
  EXPECT_FLOAT_EQ(*blood.at(192, 64), base);
}

// As many as the density says, on a surface that is nowhere flat.
TEST(SurfaceSkinMaps, FrecklesCoverAboutTheShareThatTheirDensityAsksFor) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  recipe.width = 1024;
  recipe.height = 512;
  recipe.features = {
      {MelaninSpots{.density = 10.0, .diameter = {2.0, 2.0}, .melanin = {0.03, 0.03}, .rim = 0.1},
       {}}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  const Image& melanin = find_map(maps, "melanin")->values;
  double dark = 0.0, all = 0.0;
  for (int y = 0; y < melanin.height; ++y) {
    const double ring = std::sin(3.14159265 * (y + 0.5) / melanin.height);
    for (int x = 0; x < melanin.width; ++x) {
      all += ring;
      if (*melanin.at(x, y) > 0.025f) dark += ring;
    }
  }
  // Spots whose middle lies off the surface are cut smaller: on average by a third of their area.
  const double of_disks = 10.0 / 100.0 * 3.14159265;
  EXPECT_GT(dark / all, 0.45 * of_disks);
  EXPECT_LT(dark / all, 1.1 * of_disks);
}

Vec3f color_of(const SkinParameters& skin) {
  static const BandSet bands = default_spectral_bands();
  static const BandWeights weights = make_skin_band_weights(bands, {});
  Vec3f color;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    const double reflectance =
        adding_doubling(skin_layer_stack(skin, bands.wavelengths()[b]), {}, {.accuracy = 1e-3})
            .totals.diffuse_reflectance;
    for (int c = 0; c < 3; ++c)
      color[c] += static_cast<float>(weights[b][static_cast<std::size_t>(c)] * reflectance);
  }
  return color;
}

// There and back: the color of a skin gives its melanin and blood, and these its color.
TEST(SkinOfColor, FindsTheSkinThatHasAColor) {
  SkinParameters skin;
  const SkinOfColor of_color(skin);
  std::vector<Vec3f> colors;
  for (const double melanin : {0.008, 0.03, 0.12})
    for (const double blood : {0.004, 0.02})
      for (const double saturation : {0.624, 0.9}) {
        skin.melanin = melanin;
        skin.hemoglobin_dermis = blood;
        skin.saturation_dermis = skin.saturation_epidermis = saturation;
        const Vec3f color = color_of(skin);
        const SkinOfColor::Value found = of_color.at(color);
        EXPECT_NEAR(found.skin.melanin / melanin, 1.0, 0.1) << melanin << ' ' << blood;
        EXPECT_NEAR(found.skin.hemoglobin_dermis / blood, 1.0, 0.25) << melanin << ' ' << blood;
        const Vec3f again = color_of(found.skin);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(again[c] / color[c], 1.0, 0.025) << melanin << ' ' << blood << ' ' << c;
        colors.push_back(2.0f * color);
      }
  // Twice as bright as skin: half the exposure makes them skin again.
  EXPECT_NEAR(match_exposure(of_color, colors).exposure, 0.5, 0.06);

  // Redder than any oxygen makes it: blood close below the surface.
  const SkinOfColor::Value lips = of_color.at({0.5f, 0.2f, 0.18f});
  EXPECT_GT(lips.skin.hemoglobin_epidermis, 0.003);
  EXPECT_DOUBLE_EQ(lips.skin.saturation_dermis, 1.0);
  EXPECT_LT(lips.error, 0.2);
}

}  // namespace
}  // namespace lamina
