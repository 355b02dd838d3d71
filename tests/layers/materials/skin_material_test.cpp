// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Skin by its recipe: what files say becomes layers, and what the presets look like.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/layers/materials/material_file.h"
#include "lamina/layers/materials/skin.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"

namespace lamina {
namespace {

/// 400 to 700 nm, every 20.
std::vector<double> wavelengths() {
  std::vector<double> all;
  for (int nm = 400; nm <= 700; nm += 20) all.push_back(nm);
  return all;
}

/// A built-in skin at those wavelengths.
Material preset(const std::string& name) {
  std::string text = builtin_material_text(name), bands;
  for (const double nm : wavelengths()) bands += (bands.empty() ? "" : ", ") + std::to_string(nm);
  text.insert(text.find("\"skin\":"), "\"bands\": [" + bands + "], ");
  return parse_material(text, name);
}

/// Specular light included, as in [Cooksey2017]. Exact totals; accurate to 1e-4.
std::vector<double> reflectances(const Material& material) {
  std::vector<double> all;
  for (std::size_t band = 0; band < material.bands.size(); ++band) {
    const SlabTotals light =
        adding_doubling(layer_stack(material, band), {}, {.accuracy = 1e-4}).totals;
    all.push_back(light.specular_reflectance + light.diffuse_reflectance);
  }
  return all;
}

Lab color(const std::vector<double>& reflectance) {
  return lab(linear_srgb(make_band_weights(BandSet(wavelengths())), reflectance));
}
Lab color(const std::string& name) { return color(reflectances(preset(name))); }

/// Individual typology angle [deg]. Source: [Chardon1991].
double typology_angle(const Lab& skin) {
  return std::atan2(skin.lightness - 50.0, skin.b) * 180.0 / std::numbers::pi;
}

struct TypeClass {
  const char* name;
  double low, high;  ///< of the typology angle [deg]
};
/// The six classes of [Chardon1991], very light to dark, in the order of the Fitzpatrick types.
constexpr TypeClass classes[] = {{"skin_type_1", 55, 90},  {"skin_type_2", 41, 55},
                                 {"skin_type_3", 28, 41},  {"skin_type_4", 10, 28},
                                 {"skin_type_5", -30, 10}, {"skin_type_6", -90, -30}};

TEST(SkinMaterial, TypesLieInTheirClassesOfColor) {
  for (const TypeClass& type : classes) {
    const Lab skin = color(type.name);
    EXPECT_GT(typology_angle(skin), type.low + 1.0) << type.name;
    EXPECT_LT(typology_angle(skin), type.high - 1.0) << type.name;
    EXPECT_GT(skin.lightness, 36.0) << type.name;  // the range of [Alaluf2002] and [Cooksey2017]
    EXPECT_LT(skin.lightness, 75.0) << type.name;
    EXPECT_GT(skin.a, 6.5) << type.name;
    EXPECT_LT(skin.a, 14.0) << type.name;
    EXPECT_GT(skin.b, 10.0) << type.name;
    EXPECT_LT(skin.b, 23.0) << type.name;
  }
}

// The numbers in the comments of their files.
TEST(SkinMaterial, StatesLookAsTheirCommentsSay) {
  const Lab usual = color("skin_type_2"), flushed = color("skin_flushed"),
            pale = color("skin_pale"), burnt = color("skin_sunburnt"), palm = color("skin_palm"),
            lip = color("skin_lip"), dark = color("skin_type_6");
  EXPECT_GT(flushed.a, usual.a + 3.0);
  EXPECT_GT(burnt.a, flushed.a);
  EXPECT_LT(burnt.lightness, flushed.lightness);
  EXPECT_LT(pale.a, usual.a - 3.0);
  EXPECT_GT(pale.lightness, usual.lightness + 3.0);
  EXPECT_LT(color_difference(palm, {62, 10, 15}), 1.0);
  EXPECT_LT(color_difference(lip, {53, 19, 10}), 1.0);
  EXPECT_LT(color_difference(dark, {38, 11, 15}), 1.0);
  EXPECT_NEAR(typology_angle(dark), -38.0, 1.0);
}

// [Xiao2017] Table: back of hand, Thai. [Alaluf2002]: forearm in the sun, Indian,
// whose 43.7, 12.9, 17.2 for the observer of 1964 are 44.2, 13.6, 17.3 for that of 1931.
// [JablonskiChaplin2000]: darkest inner arms.
TEST(SkinMaterial, TanAndBrownHaveTheColorsThatWereMeasured) {
  EXPECT_LT(color_difference(color("skin_tan"), {57.6, 9.4, 19.0}), 0.3);
  EXPECT_LT(color_difference(color("skin_brown"), {44.2, 13.6, 17.3}), 0.3);
  EXPECT_LT(color_difference(color("skin_deep"), {29.5, 7.4, 8.2}), 0.3);
  const Material deep = find_sampled_material("skin_deep", std::vector{680.0, 685.0, 690.0});
  EXPECT_NEAR(reflectances(deep)[1], 0.13, 0.002);
  EXPECT_LT(reflectances(deep)[1], 0.193);
}

/// The mean spectrum of the forearms of [Cooksey2017] whose typology angle lies in a class, at
/// wavelengths(); empty if the data are absent.
std::vector<double> measured_mean(const TypeClass& type) {
  std::ifstream stream(std::filesystem::path(LAMINA_SHARED_DATA) /
                       "skin/nist_skin_reflectance_mean_vis.csv");
  std::vector<double> nm;
  std::vector<std::vector<double>> rows;  // [wavelength][subject]
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("#") || line.starts_with("wave")) continue;
    std::istringstream fields(line);
    std::string field;
    std::getline(fields, field, ',');
    nm.push_back(std::stod(field));
    for (rows.emplace_back(); std::getline(fields, field, ',');)
      rows.back().push_back(std::stod(field));
  }
  std::vector<double> mean;
  if (rows.empty()) return mean;
  int count = 0;
  for (std::size_t subject = 0; subject < rows[0].size(); ++subject) {
    std::vector<double> spectrum;
    for (const double wavelength : wavelengths()) {
      std::size_t i = 1;
      while (nm[i] < wavelength) ++i;
      const double t = (wavelength - nm[i - 1]) / (nm[i] - nm[i - 1]);
      spectrum.push_back((1.0 - t) * rows[i - 1][subject] + t * rows[i][subject]);
    }
    const double angle = typology_angle(color(spectrum));
    if (angle <= type.low || angle > type.high) continue;
    ++count;
    mean.resize(spectrum.size());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += spectrum[i];
  }
  for (double& value : mean) value /= count;
  return mean;
}

TEST(SkinMaterial, TypesReflectAsTheMeanOfMeasuredForearmsOfTheirClass) {
  for (const TypeClass& type : std::span(classes).first(5)) {
    const std::vector<double> measured = measured_mean(type);
    if (measured.empty()) GTEST_SKIP() << "reference data are absent: NIST skin reflectance";
    const std::vector<double> modeled = reflectances(preset(type.name));
    double sum = 0.0;
    for (std::size_t i = 0; i < measured.size(); ++i)
      sum += (modeled[i] - measured[i]) * (modeled[i] - measured[i]);
    EXPECT_LT(std::sqrt(sum / static_cast<double>(measured.size())), 0.0065) << type.name;
    EXPECT_LT(color_difference(color(modeled), color(measured)), 1.0) << type.name;
  }
}

Material skin(const std::string& recipe, const std::string& more = "\"bands\": [540], ") {
  return parse_material(R"({"lamina": "material", "version": 1, "length_unit": "mm", )" + more +
                            "\"skin\": {" + recipe + "}}",
                        "f");
}

TEST(SkinMaterial, IsTheStackOfItsParameters) {
  const Material material = skin(R"("melanin": 0.1, "carotene": 0.003, "oiliness": 0.4)", "");
  EXPECT_EQ(material.bands, default_spectral_bands());
  EXPECT_EQ(material.oiliness, 0.4);
  EXPECT_EQ(material.source, "melanin: Jacques 1998; constants: calibrated");
  ASSERT_EQ(material.layers.size(), 3U);
  EXPECT_EQ(material.layers[1].name, "junction");
  for (std::size_t band = 0; band < 8; ++band) {
    const LayerStack expected =
        skin_layer_stack({.melanin = 0.1, .carotene = 0.003}, material.bands.wavelengths()[band]);
    const LayerStack stack = layer_stack(material, band);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(stack.layers()[i].medium.sigma_a, expected.layers()[i].medium.sigma_a);
      EXPECT_EQ(stack.layers()[i].medium.sigma_s, expected.layers()[i].medium.sigma_s);
      EXPECT_EQ(stack.layers()[i].thickness, expected.layers()[i].thickness);
    }
  }
}

TEST(SkinMaterial, OwnConstantsStandBeforeThoseOfTheSet) {
  const Medium paper = layer_stack(skin(R"("constants": "paper")"), 0).layers()[0].medium;
  const Medium half =
      layer_stack(skin(R"("scattering_scale": 0.5, "constants": "paper")"), 0).layers()[0].medium;
  EXPECT_NEAR(half.sigma_s, 0.5 * paper.sigma_s, 1e-12);
  EXPECT_EQ(half.sigma_a, paper.sigma_a);
  EXPECT_NE(skin(R"("constants": "paper")").source.find("constants: paper"), std::string::npos);
}

TEST(SkinMaterial, FoldOfSkinIsTheSameFromBothSides) {
  const LayerStack fold =
      layer_stack(skin("\"dermis_thickness\": 1.5", "\"ior_below\": 1, \"bands\": [540], "), 0);
  ASSERT_EQ(fold.layers().size(), 5U);
  const SlabTotals front = adding_doubling(fold).totals,
                   back = adding_doubling(flipped(fold)).totals;
  EXPECT_NEAR(front.diffuse_reflectance, back.diffuse_reflectance, 1e-5);
  EXPECT_NEAR(front.transmittance, back.transmittance, 1e-5);
  EXPECT_GT(front.transmittance, 0.001);
}

TEST(SkinMaterial, ThickFoldIsTheHalfSpace) {
  const LayerStack fold =
      layer_stack(skin("\"dermis_thickness\": 50", "\"ior_below\": 1, \"bands\": [540], "), 0);
  EXPECT_NEAR(adding_doubling(fold).totals.diffuse_reflectance,
              adding_doubling(layer_stack(skin(""), 0)).totals.diffuse_reflectance, 1e-5);
}

// About P of the light that crosses; more, because what the dermis sends back crosses again, and
// less where light is not yet diffuse.
TEST(SkinMaterial, JunctionTakesItsShareOfTheLightThatCrosses) {
  const double p = 0.0175;
  const auto absorbed_below = [](const std::string& junction) {
    const Material material =
        skin(R"("melanin": 0, "hemoglobin_dermis": 0.1, "junction_absorption": )" + junction);
    return adding_doubling(layer_stack(material, 0)).totals.absorptance.back();
  };
  const double lost = 1.0 - absorbed_below("0.0175") / absorbed_below("0");
  EXPECT_GT(lost, 0.8 * p);
  EXPECT_LT(lost, 2.5 * p);  // light that comes back crosses it again
}

TEST(SkinMaterial, JunctionAbsorbsByItsSpectrum) {
  const Material inked =
      skin(R"("junction_absorption": 0.8, "junction_spectrum": [[450, 1], [550, 0.25], [600, 0]])",
           R"("bands": [400, 500, 560, 640], )");
  const double factors[] = {1.0, 0.625, 0.2, 0.0};
  for (std::size_t b = 0; b < 4; ++b) {
    const LayerStack stack = layer_stack(inked, b);
    const auto layers = stack.layers();
    EXPECT_NEAR(layers[1].thickness * (layers[1].medium.sigma_a - layers[0].medium.sigma_a),
                0.5 * 0.8 * factors[b], 1e-12);
  }
}

// Inks lie in the sheet beside what is there, each with its spectrum.
TEST(SkinMaterial, InksAddUpInTheJunction) {
  const Material inked = skin(R"("junction_absorption": 0.1, "inks": [
      { "name": "red", "absorbance": 0.8, "spectrum": [[500, 1], [600, 0]] },
      { "absorbance": 0.3 } ])",
                              R"("bands": [450, 550, 640], )");
  const double absorbances[] = {0.1 + 0.8 + 0.3, 0.1 + 0.4 + 0.3, 0.1 + 0.3};
  for (std::size_t b = 0; b < 3; ++b) {
    const LayerStack stack = layer_stack(inked, b);
    const auto layers = stack.layers();
    EXPECT_NEAR(layers[1].thickness * (layers[1].medium.sigma_a - layers[0].medium.sigma_a),
                0.5 * absorbances[b], 1e-12);
  }
  ASSERT_TRUE(inked.skin);
  EXPECT_NEAR(junction_absorbance(inked.skin->skin, 550.0), absorbances[1], 1e-12);
}

// Diffusion is too bright by .03 in light skin, and somewhat less with the constants made for it.
TEST(SkinMaterial, DiffusionIsTooBrightAndLessSoWithItsOwnConstants) {
  const auto by_diffusion = [](SkinConstants constants) {
    const SkinParameters skin = with_constants(
        {.melanin = 0.0083, .hemoglobin_epidermis = 0.0012, .hemoglobin_dermis = 0.0031},
        constants);
    double sum = 0.0;
    for (const double nm : wavelengths())
      sum += diffusion_totals(skin_layer_stack(skin, nm), {}).diffuse_reflectance;
    return sum / static_cast<double>(wavelengths().size());
  };
  double exact = 0.0;
  for (const double value : reflectances(preset("skin_type_2"))) exact += value;
  exact =
      exact / static_cast<double>(wavelengths().size()) - 0.0278;  // specular at an index of 1.4
  const double made_for_it = by_diffusion(SkinConstants::calibrated_diffusion) - exact;
  const double mixed_up = by_diffusion(SkinConstants::calibrated) - exact;
  EXPECT_NEAR(mixed_up, 0.03, 0.005);
  EXPECT_LT(made_for_it, 0.85 * mixed_up);
  EXPECT_GT(made_for_it, 0.5 * mixed_up);
}

}  // namespace
}  // namespace lamina
