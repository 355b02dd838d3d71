// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/maps/skin_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <numeric>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/layers/materials/leaf.h"
#include "lamina/skin/maps/files/material_map_file.h"
#include "lamina/skin/maps/files/skin_maps_file.h"
#include "lamina/skin/maps/skin_features.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class SkinMapFiles : public ::testing::Test {
 protected:
  SkinMapFiles() { fs::create_directories(folder_); }
  ~SkinMapFiles() override { fs::remove_all(folder_); }

  void save(const std::string& name, const std::vector<float>& values) {
    Image image = make_image(static_cast<int>(values.size()), 1, {"Y"});
    image.pixels = values;
    save_exr(image, folder_ / name, ExrPrecision::single_float);
  }
  [[nodiscard]] SkinMaps decode(const std::string& recipe) const {
    const JsonDocument document = parse_json(recipe, (folder_ / "patch.json").string());
    return decode_skin_maps(document.root());
  }
  [[nodiscard]] std::string message_of(const std::string& recipe) const {
    try {
      (void)decode(recipe);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_ = fs::temp_directory_path() / "lamina_skin_maps_test";
};

TEST_F(SkinMapFiles, AreScaledAndNamed) {
  save("m.exr", {0.0f, 0.5f, 1.0f});
  const SkinMaps maps =
      decode(R"({"melanin": {"map": "m.exr", "scale": 0.1, "offset": 0.01}, "carotene": 0.002})");
  EXPECT_DOUBLE_EQ(maps.skin.carotene, 0.002);
  ASSERT_EQ(maps.maps.size(), 1u);
  EXPECT_EQ(maps.maps[0].name, "melanin");
  EXPECT_EQ(maps.maps[0].parameter, &SkinParameters::melanin);
  EXPECT_FLOAT_EQ(maps.maps[0].values.pixels[0], 0.01f);
  EXPECT_FLOAT_EQ(maps.maps[0].values.pixels[2], 0.11f);
  EXPECT_TRUE(maps.warnings.empty());
}

TEST_F(SkinMapFiles, AreKeptWithinClampAndMultiplied) {
  save("m.exr", {0.0f, 0.5f, 1.0f});
  const SkinMaps maps =
      decode(R"({"melanin": {"map": "m.exr", "value": 0.2, "scale": 2, "clamp": [0.1, 1.5]}})");
  EXPECT_FLOAT_EQ(maps.maps[0].values.pixels[0], 0.02f);
  EXPECT_FLOAT_EQ(maps.maps[0].values.pixels[1], 0.2f);
  EXPECT_FLOAT_EQ(maps.maps[0].values.pixels[2], 0.3f);
}

TEST_F(SkinMapFiles, AreClampedToTheRangeWithACount) {
  save("m.exr", {-0.1f, 0.2f, 0.9f, 0.7f});
  const SkinMaps maps = decode(R"({"melanin": {"map": "m.exr"}})");
  EXPECT_EQ(maps.maps[0].values.pixels, (std::vector<float>{0.0f, 0.2f, 0.5f, 0.5f}));
  ASSERT_EQ(maps.warnings.size(), 1u);
  EXPECT_EQ(maps.warnings[0], "skin.melanin: 3 of 4 texels lie outside [0, 0.5] and were clamped");
}

// float(0.05) lies above 0.05: a map that is clamped to its range is taken.
TEST_F(SkinMapFiles, OfEveryNumberAreTakenAtBothEndsOfItsRange) {
  save("low.exr", {-1e9f, -1e9f, -1e9f});
  save("high.exr", {1e9f, 1e9f, 1e9f});
  std::vector<std::string> skin, leaf;
  for (const SkinParameterRange& range : skin_parameter_ranges()) skin.emplace_back(range.name);
  for (const LeafParameterRange& range : leaf_parameter_ranges()) leaf.emplace_back(range.name);
  skin.emplace_back("oiliness");
  for (const auto& [recipe, names] : {std::pair{"skin", skin}, std::pair{"leaf", leaf}})
    for (const std::string& name : names)
      for (const char* file : {"low.exr", "high.exr"}) {
        const std::string map = "\"" + name + R"(": {"map": ")" + file + "\"}";
        const bool is_fold = recipe == std::string("skin") && name != "dermis_thickness";
        const std::string text =
            R"({"lamina": "material", "version": 1, "length_unit": "mm", "ior_below": 1, ")" +
            std::string(recipe) + "\": {" + map + (is_fold ? R"(, "dermis_thickness": 2)" : "") +
            "}}";
        const JsonDocument document = parse_json(text, (folder_ / "m.json").string());
        try {
          const MappedMaterial mapped = decode_mapped_material(document.root());
          ASSERT_EQ(mapped.maps.size(), 1u) << name;
          EXPECT_FALSE(mapped.warnings.empty()) << name;
          const MaterialMap& of = mapped.maps[0];
          for (const float value : of.values.pixels) {
            EXPECT_GE(static_cast<double>(value), of.number.low) << name;
            EXPECT_LE(static_cast<double>(value), of.number.high) << name;
          }
        } catch (const InvalidInput& error) {
          ADD_FAILURE() << name << ": " << error.what();
        }
      }
}

TEST_F(SkinMapFiles, AreRefusedWithTheFieldAndTheReason) {
  save("bad.exr", {0.1f, std::numeric_limits<float>::quiet_NaN()});
  EXPECT_NE(message_of(R"({"melanin": {"map": "bad.exr"}})").find("nan"), std::string::npos);
  EXPECT_NE(message_of(R"({"melanin": {"map": "bad.exr"}})").find("melanin.map"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"melanin": {"map": "none.exr"}})").find("none.exr"), std::string::npos);
  save("m.exr", {0.1f});
  EXPECT_NE(message_of(R"({"melanin": {"noise": {"size": 1}}})").find("images"), std::string::npos);
  EXPECT_NE(message_of(R"({"inks": [{"absorbance": 1}, {"absorbance": 11}]})").find("inks[1]"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"melanin": {"map": "m.exr", "channel": "Q"}})").find("\"Q\""),
            std::string::npos);
  EXPECT_NE(message_of(R"({"melanim": 0.1})").find("melanin"), std::string::npos);
  EXPECT_NE(message_of(R"({"melanin": 0.7})").find("0.5"), std::string::npos);
}

TEST(SkinSpectrum, GivesTheSameAbsorptionAsTheFunctionsOfWavelength) {
  const SkinParameters skin{.melanin = 0.03, .carotene = 0.004, .saturation_dermis = 0.8};
  for (const double nm : {400.0, 540.0, 645.0}) {
    EXPECT_EQ(epidermis_absorption(skin, skin_spectrum(nm)), epidermis_absorption(skin, nm));
    EXPECT_EQ(dermis_absorption(skin, skin_spectrum(nm)), dermis_absorption(skin, nm));
  }
}

SkinMapRecipe recipe_of(std::vector<SkinFeature> features) {
  SkinMapRecipe recipe;
  recipe.width = recipe.height = 100;
  recipe.mm_per_texel = 0.2;
  recipe.seed = 4;
  recipe.base.skin.melanin = 0.02;
  recipe.base.skin.hemoglobin_dermis = 0.01;
  recipe.features = std::move(features);
  return recipe;
}

const SkinMap& map_of(const std::vector<SkinMap>& maps, std::string_view name) {
  for (const SkinMap& map : maps)
    if (map.name == name) return map;
  throw std::runtime_error("no map " + std::string(name));
}

double mean(const Image& image) {
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
         static_cast<double>(image.pixels.size());
}

TEST(SkinFeatures, AreTheSameForTheSameSeedOnly) {
  SkinMapRecipe recipe = recipe_of({Unevenness{}, MelaninSpots{}, Veins{}, Blotches{}});
  const auto first = make_skin_maps(recipe), again = make_skin_maps(recipe);
  recipe.seed = 5;
  const auto other = make_skin_maps(recipe);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_EQ(first[i].values.pixels, again[i].values.pixels);
  EXPECT_NE(map_of(first, "melanin").values.pixels, map_of(other, "melanin").values.pixels);
}

TEST(SkinFeatures, StayInTheRangesOfTheParameters) {
  const auto maps = make_skin_maps(
      recipe_of({MelaninSpots{.density = 200, .melanin = {0.4, 0.9}},
                 Veins{.count = 9, .hemoglobin = 1.0}, Blotches{.hemoglobin_dermis = 0.1}}));
  for (const SkinMap& map : maps)
    for (const SkinParameterRange& range : skin_parameter_ranges())
      if (range.name == map.name)
        for (const float value : map.values.pixels) {
          ASSERT_GE(value, static_cast<float>(range.low)) << map.name;
          ASSERT_LE(value, static_cast<float>(range.high)) << map.name;
        }
}

TEST(SkinFeatures, FrecklesCoverTheAreaOfTheirDiscsAndMixTheirMelanin) {
  const auto maps = make_skin_maps(recipe_of({MelaninSpots{
      .density = 5, .diameter = {1.0, 1.0}, .melanin = {0.05, 0.05}, .melanin_blend = 0.2}}));
  const Image& melanin = map_of(maps, "melanin").values;
  // 5 per cm² of discs of 1 mm, stretched by up to 1.25 along and across alike
  const double covered = (mean(melanin) - 0.02) / 0.05;
  EXPECT_NEAR(covered, 5.0 * std::numbers::pi * 0.25 / 100.0, 0.4 * 0.0393);
  const Image& blend = map_of(maps, "melanin_blend").values;
  for (std::size_t i = 0; i < blend.pixels.size(); ++i) {
    const double added = melanin.pixels[i] - 0.02;
    EXPECT_NEAR(blend.pixels[i], (0.02 * 0.6 + added * 0.2) / melanin.pixels[i], 1e-4);
  }
}

TEST(SkinFeatures, VeinsBringVenousBloodAlongLines) {
  const auto maps = make_skin_maps(recipe_of({Veins{.count = 1}}));
  const Image& blood = map_of(maps, "hemoglobin_dermis").values;
  const Image& saturation = map_of(maps, "saturation_dermis").values;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < blood.pixels.size(); ++i) {
    EXPECT_GE(blood.pixels[i], 0.01f - 1e-6f);
    if (blood.pixels[i] < 0.02f) continue;
    ++inside;
    EXPECT_LT(saturation.pixels[i], 0.6f);
  }
  EXPECT_GT(inside, 100u);  // a line across 100 texels, not all of them
  EXPECT_LT(inside, 4000u);
}

TEST(SkinFeatures, VeinsOfMoreLevelsCoverMoreSkinByThinnerTubes) {
  const auto covered = [](int levels, float share) {
    const auto maps = make_skin_maps(recipe_of({Veins{.count = 4,
                                                      .levels = levels,
                                                      .diameter = {1.0, 1.0},
                                                      .depth = {0.0, 0.0},
                                                      .hemoglobin = 0.05}}));
    const Image& blood = map_of(maps, "hemoglobin_dermis").values;
    return std::ranges::count_if(blood.pixels, [&](float b) { return b > 0.01f + 0.05f * share; });
  };
  EXPECT_GT(covered(1, 0.5f), covered(0, 0.5f));
  EXPECT_GT(covered(3, 0.5f), covered(1, 0.5f));
}

TEST(SkinFeatures, PressingTakesBloodFromTheDiscOnly) {
  const auto maps =
      make_skin_maps(recipe_of({PressedDisc{.at = {10.0, 10.0}, .diameter = 8.0, .share = 0.75}}));
  const Image& blood = map_of(maps, "hemoglobin_dermis").values;
  EXPECT_NEAR(*blood.at(50, 50), 0.0025, 1e-6);
  EXPECT_NEAR(*blood.at(2, 2), 0.01, 1e-6);
  EXPECT_EQ(maps.size(), 2u);  // of epidermis and dermis
}

// Blood comes back from the rim: less at the middle of the rim's way, the same at the disc's
// middle. What has opened around it holds more than before, and nothing changes far away.
TEST(SkinFeatures, PressedSkinRefillsFromItsRim) {
  const PressedDisc pressed{.diameter = 8.0, .share = 0.75};
  PressedDisc refilled = pressed;
  refilled.refill = 1.0;
  refilled.hyperemia = 0.5;
  EXPECT_DOUBLE_EQ(share_left(pressed, 0.0, 0.0), 0.25);
  EXPECT_NEAR(share_left(refilled, 0.0, 0.0), 0.25, 0.01);
  EXPECT_GT(share_left(refilled, 2.8, 0.0), share_left(pressed, 2.8, 0.0) + 0.1);
  EXPECT_GT(share_left(refilled, 6.5, 0.0), 1.2);
  EXPECT_NEAR(share_left(refilled, 14.0, 0.0), 1.0, 1e-3);
}

TEST(SkinFeatures, InkLiesAtTheJunctionWhereTheImageIsDark) {
  Tattoo tattoo{.at = {10.0, 10.0}, .width = 8.0, .absorbance = 2.0};
  tattoo.image = make_image(4, 4, {"Y"});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 2; ++x) *tattoo.image.at(x, y) = 1.0f;  // its left half
  const auto maps = make_skin_maps(recipe_of({tattoo}));
  ASSERT_EQ(maps.size(), 1u);
  const Image& ink = map_of(maps, "junction_absorption").values;
  EXPECT_NEAR(*ink.at(35, 50), 0.0175 + 2.0, 1e-5);
  EXPECT_NEAR(*ink.at(65, 50), 0.0175, 1e-5);
  EXPECT_NEAR(*ink.at(5, 50), 0.0175, 1e-5);
}

}  // namespace
}  // namespace lamina
