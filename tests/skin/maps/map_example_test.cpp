// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/map_example.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

#include "lamina/base/image/files/image_file.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"

namespace lamina {
namespace {

/// Freckles with their own melanin on uneven skin, more blood where there is more melanin.
std::vector<SkinMap> freckled_maps(int side) {
  SkinMapRecipe recipe;
  recipe.width = recipe.height = side;
  recipe.mm_per_texel = 0.15;
  recipe.seed = 2;
  recipe.features = {Blotches{.size = 2.0, .hemoglobin_dermis = 0.01, .melanin = 0.01},
                     Unevenness{}, MelaninSpots{.density = 20.0, .diameter = {0.8, 2.0}}};
  return make_skin_maps(recipe);
}

SkinMapRecipe spread_recipe(std::vector<SkinMap> maps, int side) {
  SkinMapRecipe recipe;
  recipe.width = recipe.height = side;
  recipe.mm_per_texel = 0.15;
  recipe.seed = 1;
  recipe.features = {Synthesis{MapExample(std::move(maps), 0.15, 7.0)}};
  return recipe;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  const double ma = mean(a), mb = mean(b);
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double da = static_cast<double>(a[i]) - ma, db = static_cast<double>(b[i]) - mb;
    aa += da * da;
    bb += db * db;
    ab += da * db;
  }
  return ab / std::sqrt(aa * bb);
}

/// Largest difference between the shares of values below a level (Kolmogorov's distance).
double distance_of_histograms(std::vector<float> a, std::vector<float> b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto share = [&](auto place) {
      return static_cast<double>(place - b.begin()) / static_cast<double>(b.size());
    };
    const double here = (static_cast<double>(i) + 0.5) / static_cast<double>(a.size());
    const double low = share(std::ranges::lower_bound(b, a[i]));
    const double high = share(std::ranges::upper_bound(b, a[i]));
    most = std::max({most, low - here, here - high});  // equal values stand for a range of shares
  }
  return most;
}

/// Mean difference between neighbours.
double roughness(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 1; x < image.width; ++x)
      sum += std::abs(static_cast<double>(*image.at(x, y) - *image.at(x - 1, y)));
  return sum / (image.height * (image.width - 1));
}

/// One patch of 19 mm over 54 mm: eight times its area.
struct SpreadFreckles {
  std::vector<SkinMap> example = freckled_maps(128),
                       spread = make_skin_maps(spread_recipe(example, 360));
};
const SpreadFreckles& spread_freckles() {
  static const SpreadFreckles freckles;
  return freckles;
}

// The bounds are what sixty tiles of one example leave to chance.
TEST(MapExample, KeepsMeansHistogramsDetailAndWhatLiesTogether) {
  const auto& [example, spread] = spread_freckles();
  ASSERT_EQ(spread.size(), example.size());
  for (std::size_t m = 0; m < example.size(); ++m) {
    ASSERT_EQ(spread[m].name, example[m].name);
    const Image &from = example[m].values, &to = spread[m].values;
    EXPECT_NEAR(mean(to.pixels) / mean(from.pixels), 1.0, 0.06) << example[m].name;
    EXPECT_LT(distance_of_histograms(from.pixels, to.pixels), 0.08) << example[m].name;
    EXPECT_NEAR(roughness(to) / roughness(from), 1.0, 0.2) << example[m].name;
    for (std::size_t n = 0; n < m; ++n)
      EXPECT_NEAR(correlation(to.pixels, spread[n].values.pixels),
                  correlation(from.pixels, example[n].values.pixels), 0.12)
          << example[m].name << " and " << example[n].name;
  }
}

// Where tiles meet nothing changes faster than it does within the example.
TEST(MapExample, HasNoSeamsAndDoesNotRepeat) {
  const auto& [example, spread] = spread_freckles();
  const auto steps = [](const Image& image) {
    std::vector<float> all;
    for (int y = 0; y < image.height; ++y)
      for (int x = 1; x < image.width; ++x)
        all.push_back(std::abs(*image.at(x, y) - *image.at(x - 1, y)));
    std::ranges::sort(all);
    return all;
  };
  const std::vector<float> before = steps(example[0].values), after = steps(spread[0].values);
  EXPECT_LT(after.back(), 1.1f * before.back());
  EXPECT_LT(after[after.size() * 999 / 1000], 1.1f * before[before.size() * 999 / 1000]);
  // Shifted by any multiple of 16 texels it looks like another piece of skin.
  const Image& melanin = spread[0].values;
  for (int shift = 32; shift <= 160; shift += 16) {
    std::vector<float> here, there;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) {
        here.push_back(*melanin.at(x, y));
        there.push_back(*melanin.at(x + shift, y + shift / 2));
      }
    EXPECT_LT(std::abs(correlation(here, there)), 0.2) << shift;
  }
}

TEST(MapExample, IsTheSameForTheSameSeedOnly) {
  SkinMapRecipe recipe = spread_recipe(freckled_maps(64), 80);
  const auto first = make_skin_maps(recipe), again = make_skin_maps(recipe);
  recipe.seed = 9;
  const auto other = make_skin_maps(recipe);
  EXPECT_EQ(first[0].values.pixels, again[0].values.pixels);
  EXPECT_NE(first[0].values.pixels, other[0].values.pixels);
}

// In texels four times as wide the mean stays, and what is finer than they are has gone.
TEST(MapExample, AveragesWhatTexelsCannotShow) {
  SkinMapRecipe recipe = spread_recipe(freckled_maps(128), 90);
  recipe.mm_per_texel = 0.6;
  const std::vector<float> coarse = make_skin_maps(recipe)[0].values.pixels;
  const std::vector<float>& fine = spread_freckles().spread[0].values.pixels;
  EXPECT_NEAR(mean(coarse) / mean(fine), 1.0, 0.08);
  const auto spread = [](const std::vector<float>& values) {
    const double middle = mean(values);
    double sum = 0.0;
    for (const float value : values)
      sum += (static_cast<double>(value) - middle) * (static_cast<double>(value) - middle);
    return std::sqrt(sum / static_cast<double>(values.size()));
  };
  EXPECT_LT(spread(coarse), 0.9 * spread(fine));
}

// As factors the example's mean is 1: what it lies over keeps its own mean.
TEST(MapExample, AsFactorsLeavesTheMean) {
  SkinMapRecipe recipe = spread_recipe(freckled_maps(128), 200);
  recipe.base.skin.melanin = 0.2;
  std::get<Synthesis>(recipe.features[0]).are_factors = true;
  EXPECT_NEAR(mean(make_skin_maps(recipe)[0].values.pixels), 0.2, 0.2 * 0.08);
}

// Melanin beyond its range in one texel, and blood whose first channel is the same everywhere.
TEST(MapExample, OfAPatchWithOddMapsSaysSo) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "patch_of_odd_maps";
  std::filesystem::create_directories(folder);
  Image melanin = make_image(64, 64, {"Y"}), blood = make_image(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    melanin.pixels[i] = 0.01f + 1e-5f * static_cast<float>(i % 64);
    blood.pixels[3 * i] = 0.01f;
    blood.pixels[3 * i + 1] = 0.001f * static_cast<float>(i % 7);
  }
  melanin.pixels[5] = 7.0f;
  save_exr(melanin, folder / "melanin.exr", ExrPrecision::single_float);
  save_exr(blood, folder / "blood.exr", ExrPrecision::single_float);
  std::ofstream(folder / "patch.json")
      << R"({ "lamina": "patch", "version": 1, "mm_per_pixel": 0.1, "skin": {
               "melanin": { "map": "melanin.exr" }, "hemoglobin_dermis": { "map": "blood.exr" } } })";
  std::ofstream(folder / "maps.json")
      << R"({ "lamina": "maps", "version": 1, "width": 64, "height": 64, "mm_per_pixel": 0.1,
              "skin": {}, "features": [ { "synthesis": { "patch": "patch.json" } } ] })";
  const SkinMapRecipe recipe = load_skin_map_recipe(folder / "maps.json");
  const auto& warnings = std::get<Synthesis>(recipe.features.at(0)).warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("patch.json: "), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("clamped"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("map of hemoglobin_dermis: the same everywhere"), std::string::npos)
      << warnings[1];
}

}  // namespace
}  // namespace lamina
