// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scene/skin_surface/surface_skin_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/skin/acquire/files/capture_file.h"
#include "lamina/skin/acquire/skin_acquisition.h"
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

/// Linear sRGB of uniform skin in light from all sides, band by band.
std::array<float, 3> color_of(const SkinParameters& skin) {
  const auto& [wavelengths, weights] = srgb_sensor();
  std::array<float, 3> color = {};
  for (std::size_t w = 0; w < wavelengths.size(); ++w) {
    const double reflectance = adding_doubling(skin_layer_stack(skin, wavelengths[w]),
                                               {.is_diffuse = true}, {.accuracy = 1e-3})
                                   .totals.diffuse_reflectance;
    for (std::size_t c = 0; c < 3; ++c) color[c] += static_cast<float>(weights(c, w) * reflectance);
  }
  return color;
}

// A texture is one skin, whether maps or an acquisition asks for it.
TEST(ColorOfSkin, IsTheSkinThatAcquisitionsFind) {
  constexpr int side = 8;
  Image texture = make_image(side, side, {"R", "G", "B"});
  const std::array<std::array<float, 3>, 4> colors = {
      {{0.45f, 0.29f, 0.22f}, {0.3f, 0.17f, 0.11f}, {0.5f, 0.3f, 0.25f}, {0.12f, 0.06f, 0.035f}}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      std::ranges::copy(colors[static_cast<std::size_t>(2 * (y / 4) + x / 4)], texture.at(x, y));
  const auto folder = std::filesystem::temp_directory_path();
  save_exr(texture, folder / "lamina_color_of_skin.exr", ExrPrecision::single_float);
  std::ofstream(folder / "lamina_color_of_skin.json")
      << R"({ "lamina": "capture", "version": 1, "images": [ { "image": "lamina_color_of_skin.exr",
              "encoding": "linear", "sensor": "srgb" } ] })";
  Capture capture = develop_capture(load_capture(folder / "lamina_color_of_skin.json"));
  const AcquiredSkin acquired =
      acquire_skin(capture, plan_acquisition(capture, LateralLight::automatic), {}).skin;
  SurfaceMapRecipe recipe{.width = side, .height = side, .meshes = {make_square(20.0f)}};
  recipe.features = {{ColorOfSkin{texture, 1.0}, {}}};
  const std::vector<SkinMap> maps = make_surface_maps(recipe);
  EXPECT_EQ(acquired.numbers.size(), 8u);
  for (const AcquiredNumber& number : acquired.numbers)
    for (double SkinParameters::*const value : number.number.values) {
      const auto map = std::ranges::find(maps, value, &SkinMap::parameter);
      ASSERT_NE(map, maps.end()) << number.number.parameter.name;
      for (std::size_t i = 0; i < map->values.pixels.size(); ++i)
        EXPECT_NEAR(map->values.pixels[i], number.values.pixels[i],
                    1e-4f * number.values.pixels[i] + 1e-7f)
            << map->name << ' ' << i;
    }
}

// Independent: adding-doubling gives colors that skin is found for, and the color of what is found,
// but for what the model misses of people: a hundredth of the light.
TEST(ColorOfSkin, IsTheSkinThatHasTheColor) {
  const TextureSkin texture({});
  const SkinLookup lookup = texture.lookup();
  std::vector<std::array<float, 3>> colors;
  for (const double melanin : {0.008, 0.03, 0.12})
    for (const double blood : {0.004, 0.012}) {
      SkinParameters skin;
      skin.melanin = melanin;
      skin.hemoglobin_dermis = blood;
      const std::array<float, 3> color = color_of(skin);
      const ColorFit found = lookup.at(color);
      EXPECT_LT(found.distance, farthest_skin);
      const std::vector<double> values(
          found.values.begin(),
          found.values.begin() + static_cast<std::ptrdiff_t>(texture.numbers.size()));
      const std::array<float, 3> again = color_of(with_numbers({}, texture.numbers, values));
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(again[c], color[c], 0.015f) << melanin << ' ' << blood << ' ' << c;
      colors.push_back({2.0f * color[0], 2.0f * color[1], 2.0f * color[2]});
    }
  // Twice as bright as skin: half the exposure makes them skin again.
  EXPECT_NEAR(match_exposure(lookup, colors).exposure, 0.5, 0.1);
}

}  // namespace
}  // namespace lamina
