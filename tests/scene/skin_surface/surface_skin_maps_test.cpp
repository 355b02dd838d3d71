// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/skin_surface/surface_skin_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "render/small_scenes.h"

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

// Texels four times as wide as high, 2 mm: between texels the melanin is nearly as steep
// across as along, so that spots are round. Sampled sharp, 1.86 times as steep
// along.
TEST(SurfaceSkinMaps, SpotsAreRoundWhereTheTextureIsStretched) {
  SurfaceMapRecipe recipe{.width = 50, .height = 200, .seed = 3};
  recipe.meshes = {make_square(100.0f)};
  recipe.base.skin.melanin = 0.01;
  recipe.features = {
      {MelaninSpots{.density = 4.0, .diameter = {3.0, 3.0}, .melanin = {0.03, 0.03}}, {}}};
  const Image melanin = find_map(make_surface_maps(recipe), "melanin")->values;
  double along = 0.0, across = 0.0;  // squares of slopes, over 2 mm
  for (int y = 0; y + 4 < melanin.height; ++y)
    for (int x = 0; x + 1 < melanin.width; ++x) {
      across += std::pow((*melanin.at(x + 1, y) - *melanin.at(x, y)) / 2.0, 2);
      along += std::pow((*melanin.at(x, y + 1) - *melanin.at(x, y)) / 0.5, 2);
    }
  EXPECT_GT(across, 0.0);
  EXPECT_LT(std::sqrt(along / across), 1.5);
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

/// Maps of 20 mm of freckled skin.
MapExample freckled_example() {
  SkinMapRecipe recipe;
  recipe.width = recipe.height = 100;
  recipe.mm_per_texel = 0.2;
  recipe.features = {Unevenness{}, MelaninSpots{.density = 15.0, .diameter = {1.0, 3.0}}};
  return {make_skin_maps(recipe), 0.2, 7.0};
}

// The texture of the sphere ends where it begins: across that seam nothing changes more than
// anywhere else, and sizes are in mm, near the poles too.
TEST(SurfaceSkinMaps, SynthesisHasNoSeamWhereTheTextureHasOne) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  recipe.width = 512;
  recipe.height = 256;
  recipe.features = {{Synthesis{freckled_example()}, {}}};
  const Image melanin = find_map(make_surface_maps(recipe), "melanin")->values;
  /// Mean difference between two columns, over the middle of the sphere.
  const auto step = [&](int x, int next) {
    double sum = 0.0;
    for (int y = 64; y < 192; ++y)
      sum += std::abs(static_cast<double>(*melanin.at(x, y) - *melanin.at(next, y)));
    return sum;
  };
  double sum = 0.0, most = 0.0;
  for (int x = 0; x + 1 < melanin.width; ++x) {
    sum += step(x, x + 1);
    most = std::max(most, step(x, x + 1));
  }
  EXPECT_GT(sum, 0.0);
  EXPECT_LT(step(melanin.width - 1, 0), most);
  EXPECT_LT(step(melanin.width - 1, 0), 2.5 * sum / (melanin.width - 1));
}

// Ink of the left half of an image that stands upright on the equator, seen from outside.
TEST(SurfaceSkinMaps, TattooLiesAtItsPlaceInItsSize) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  recipe.width = 512;
  recipe.height = 256;
  SurfaceTattoo tattoo{.ink = {.width = 10.0, .absorbance = 1.0}, .at = {20, 0, 0}};
  tattoo.ink.image = make_image(8, 8, {"Y"});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 4; ++x) *tattoo.ink.image.at(x, y) = 1.0f;
  recipe.features = {{tattoo, {}}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  ASSERT_EQ(maps.size(), 1u);
  const Image& ink = find_map(maps, "junction_absorption")->values;
  const double base = recipe.base.skin.junction_absorption;
  double area = 0.0;  // of ink [mm²], times its absorbance
  const double texel = 2.0 * std::numbers::pi * 20.0 / 512.0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 512; ++x)
      area += (static_cast<double>(*ink.at(x, y)) - base) * texel * texel *
              std::sin(std::numbers::pi * (y + 0.5) / 256.0);
  EXPECT_NEAR(area, 50.0, 3.0);
  tattoo.at = {200, 0, 0};
  recipe.features = {{tattoo, {}}};
  EXPECT_THROW((void)make_surface_maps(recipe), InvalidInput);
}

TEST(SurfaceSkinMaps, PressingTakesBloodAroundItsPlaceOnly) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  recipe.features = {
      {SurfacePress{.disc = {.diameter = 10.0, .share = 0.75}, .at = {0, 21, 0}}, {}}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  const Image& blood = find_map(maps, "hemoglobin_dermis")->values;
  const auto base = static_cast<float>(recipe.base.skin.hemoglobin_dermis);
  EXPECT_NEAR(*blood.at(64, 64), 0.25f * base, 1e-5f);
  EXPECT_FLOAT_EQ(*blood.at(192, 64), base);
  EXPECT_FLOAT_EQ(*blood.at(64 + 32, 64), base);
}

// A vein leaves blood at both ends, but none on the other side of the sphere.
TEST(SurfaceSkinMaps, VeinRunsFromEndToEnd) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  SurfaceVein vein{.from = {0, 20, 0}, .to = {-20, 0, 0}};
  vein.look = {.diameter = {2.0, 2.0}, .depth = {0.5, 0.5}, .hemoglobin = 0.1, .absorbance = 0.2};
  recipe.features = {{vein, {}}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  const Image& blood = find_map(maps, "hemoglobin_dermis")->values;
  const auto base = static_cast<float>(recipe.base.skin.hemoglobin_dermis);
  for (int x = 64; x < 128; ++x) {  // on each meridian between them
    float most = 0.0f;
    for (int y = 0; y < 128; ++y) most = std::max(most, *blood.at(x, y));
    EXPECT_GT(most, base + 0.01f) << x;
  }
  for (int y = 0; y < 128; ++y) EXPECT_FLOAT_EQ(*blood.at(224, y), base);
  ASSERT_NE(find_map(maps, "junction_absorption"), nullptr);
}

// Branches of branches: each level adds threads, and those of no level leave one.
TEST(SurfaceSkinMaps, VeinHasLevelsOfBranches) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  const auto covered = [&](int levels) {
    SurfaceVein vein{.from = {0, 20, 0}, .to = {-20, 0, 0}};
    vein.look = {.levels = levels, .diameter = {2.0, 2.0}, .depth = {0.0, 0.2}, .hemoglobin = 0.1};
    recipe.features = {{vein, {}}};
    const std::vector<SkinMap> maps = make_surface_maps(recipe);
    const auto base = static_cast<float>(recipe.base.skin.hemoglobin_dermis);
    return std::ranges::count_if(find_map(maps, "hemoglobin_dermis")->values.pixels,
                                 [&](float blood) { return blood > base + 0.05f; });
  };
  const auto none = covered(0), one = covered(1), three = covered(3);
  EXPECT_GT(none, 0);
  EXPECT_GT(one, none + none / 10);
  EXPECT_GT(three, one);
}

// From pole to pole of a ball the straight way leaves the surface: the vein comes to an end, in
// time.
TEST(SurfaceSkinMaps, VeinEndsWhereTheSurfaceDoesNotLead) {
  SurfaceMapRecipe recipe = recipe_on_a_sphere();
  SurfaceVein vein{.from = {0, 0, 20}, .to = {0, 0, -20}};
  recipe.features = {{vein, {}}};
  for (const SkinMap& map : make_surface_maps(recipe))
    for (const float value : map.values.pixels) ASSERT_TRUE(std::isfinite(value)) << map.name;
  recipe.features = {{SurfaceVein{.from = {0, 0, 20}, .to = {0, 0, 20}}, {}}};
  EXPECT_FALSE(make_surface_maps(recipe).empty());
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
