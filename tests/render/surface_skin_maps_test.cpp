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

// There and back: the color of a skin gives its melanin and blood.
TEST(SkinOfColor, FindsTheSkinThatHasAColor) {
  SkinParameters skin;
  const SkinOfColor of_color(skin);
  const BandSet bands = default_spectral_bands();
  const BandWeights weights = make_skin_band_weights(bands, skin);
  for (const double melanin : {0.008, 0.03, 0.12})
    for (const double blood : {0.004, 0.02}) {
      skin.melanin = melanin;
      skin.hemoglobin_dermis = blood;
      Vec3f color;
      for (std::size_t b = 0; b < bands.size(); ++b) {
        const double reflectance = adding_doubling(skin_layer_stack(skin, bands.wavelengths()[b]))
                                       .totals.diffuse_reflectance;
        for (int c = 0; c < 3; ++c)
          color[c] += static_cast<float>(weights[b][static_cast<std::size_t>(c)] * reflectance);
      }
      const SkinOfColor::Value found = of_color.at(color);
      EXPECT_NEAR(found.melanin / melanin, 1.0, 0.2) << melanin << ' ' << blood;
      EXPECT_NEAR(found.hemoglobin_dermis / blood, 1.0, 0.3) << melanin << ' ' << blood;
    }
}

}  // namespace
}  // namespace lamina
