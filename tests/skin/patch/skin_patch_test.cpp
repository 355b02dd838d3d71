// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/patch/skin_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <numeric>

#include "lamina/base/image/files/image_file.h"
#include "lamina/skin/maps/files/skin_features_file.h"
#include "lamina/skin/maps/skin_features.h"
#include "lamina/skin/patch/files/skin_patch_file.h"
#include "lamina/skin/patch/patch_gradient.h"
#include "lamina/solve/reflectance/skin_colors.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/diffusion/diffuse_boundary.h"
#include "lamina/solve/scattering/diffusion/layered_diffusion.h"
#include "lamina/solve/scattering/monte_carlo/patch_photons.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "skin/patch/patch_files.h"

namespace lamina {
namespace {

namespace fs = std::filesystem;

class PatchFiles : public PatchFolder {
 protected:
  [[nodiscard]] SkinPatch load(const std::string& rest) const { return load_patch(rest); }
  [[nodiscard]] std::string message_of(const std::string& rest) const {
    return PatchFolder::message_of([&] { return load(rest); });
  }
};

SkinPatch uniform_patch(int size) {
  SkinPatch patch;
  patch.width = patch.height = size;
  patch.bands = BandSet({470.0, 645.0});
  patch.skin.skin.junction_absorption = 0.0;
  patch.totals = OperatorTotals::radiative_transfer;  // tables in less time
  patch.light = make_image(size, size, {"Y"});
  std::ranges::fill(patch.light.pixels, 1.0f);
  return patch;
}

// A band takes seconds where its tables are new: it must hear Ctrl-C in the midst of it.
TEST(SkinPatch, IsStoppedWithinABand) {
  SkinPatch patch = uniform_patch(16);
  patch.bands = BandSet({550.0});
  std::vector<double> told;
  const auto stop_after = [&](std::size_t calls) -> Progress {
    told.clear();
    return [&told, calls](double finished) {
      told.push_back(finished);
      return told.size() <= calls;
    };
  };
  (void)render_skin_patch(patch, std::nullopt, stop_after(100'000));
  EXPECT_GT(told.size(), 30u);
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_EQ(told.back(), 1.0);
  for (const std::size_t calls : {std::size_t{0}, told.size() / 2, told.size() - 2}) {
    EXPECT_THROW((void)render_skin_patch(patch, std::nullopt, stop_after(calls)), Interrupted);
    EXPECT_EQ(told.size(), calls + 1);
  }
}

// Adding-doubling of the whole stack is what `lamina slab` prints.
TEST(SkinPatch, UniformSkinReflectsAsTheSlabDoes) {
  SkinPatch patch = uniform_patch(16);
  for (const double melanin : {0.01, 0.04}) {
    patch.skin.skin.melanin = melanin;
    for (const double sheet : {0.0, 0.0175}) {
      patch.skin.skin.junction_absorption = sheet;
      const SkinPatchResult result = render_skin_patch(patch);
      for (std::size_t b = 0; b < 2; ++b) {
        const double slab =
            adding_doubling(skin_layer_stack(patch.skin.skin, patch.bands.wavelengths()[b]))
                .totals.diffuse_reflectance;
        // The sheet is a layer of half the absorbance there, met at every angle.
        EXPECT_NEAR(result.bands[b].mean_reflectance, slab, sheet == 0.0 ? 2e-4 : 0.01 * slab);
      }
    }
  }
}

// Adding-doubling takes oblique light as it is; by the fraction that enters alone skin would be 4
// to 12 % darker.
TEST(SkinPatch, UniformSkinInObliqueLightReflectsAsTheSlabDoes) {
  SkinPatch patch = uniform_patch(16);
  double without = 0.0;
  for (const double melanin : {0.01, 0.15})
    for (const double degrees : {30.0, 60.0, 80.0}) {
      patch.skin.skin.melanin = melanin;
      patch.theta = degrees * std::numbers::pi / 180.0;
      const SkinPatchResult result = render_skin_patch(patch);
      for (std::size_t b = 0; b < 2; ++b) {
        const LayerStack stack = skin_layer_stack(patch.skin.skin, patch.bands.wavelengths()[b]);
        const double slab =
            adding_doubling(stack, {.theta = patch.theta}).totals.diffuse_reflectance;
        EXPECT_NEAR(result.bands[b].mean_reflectance, slab, 2e-3 * slab) << melanin << degrees;
        const double by_entry = adding_doubling(stack).totals.diffuse_reflectance *
                                entry_transmittance(stack, {.theta = patch.theta}) /
                                entry_transmittance(stack, {});
        without = std::max(without, 1.0 - by_entry / slab);
      }
    }
  EXPECT_GT(without, 0.08);
}

// Wide halves of light and dark skin: far from their edge oblique light changes each by as much as
// its slab, by adding-doubling and by photons.
TEST(SkinPatch, ObliqueLightChangesHalvesOfSkinAsTheirSlabs) {
  SkinPatch patch = uniform_patch(16);
  patch.bands = BandSet({545.0});
  patch.mm_per_texel = 2.0;
  Image melanin = make_image(16, 16, {"Y"});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) melanin.at(x, y)[0] = x < 8 ? 0.01f : 0.2f;
  patch.skin.maps.push_back(
      {.name = "melanin", .parameter = &SkinParameters::melanin, .values = melanin});
  const Image normal = render_skin_patch(patch).image;
  const Incidence oblique{.theta = std::numbers::pi / 3.0};
  patch.theta = oblique.theta;
  const Image image = render_skin_patch(patch).image;
  for (const int x : {3, 11}) {
    SkinParameters skin = patch.skin.skin;
    skin.melanin = static_cast<double>(melanin.at(x, 0)[0]);
    const LayerStack stack = skin_layer_stack(skin, 545.0);
    const double slab = adding_doubling(stack).totals.diffuse_reflectance;
    const double change = static_cast<double>(image.at(x, 8)[0] / normal.at(x, 8)[0]);
    EXPECT_NEAR(change, adding_doubling(stack, oblique).totals.diffuse_reflectance / slab, 2e-3);
    const MonteCarloResult photons =
        trace_photons(stack, {.photons = 1'000'000, .seed = 5, .incidence = oblique});
    EXPECT_NEAR(change, photons.diffuse_reflectance.value / slab,
                4.0 * photons.diffuse_reflectance.standard_error / slab);
    EXPECT_LT(photons.diffuse_reflectance.standard_error, 5e-4);
  }
}

TEST_F(PatchFiles, GradientsInObliqueLightAreThoseOfDifferences) {
  SkinPatch patch = uniform_patch(8);
  patch.bands = BandSet({545.0});
  patch.theta = 1.2;
  Image melanin = make_image(8, 8, {"Y"});
  for (int i = 0; i < 64; ++i)
    melanin.pixels[static_cast<std::size_t>(i)] = 0.02f + 0.002f * static_cast<float>(i % 11);
  patch.skin.maps.push_back(
      {.name = "melanin", .parameter = &SkinParameters::melanin, .values = melanin});
  const auto sum_of = [](const Plane& plane) {
    return std::accumulate(plane.values.begin(), plane.values.end(), 0.0);
  };
  DifferentiableSkinPatch here(patch);
  Plane ones = make_plane(8, 8, 1.0f);
  const PatchGradient gradient = here.gradient({&ones, 1});
  constexpr std::size_t texel = 27;
  const auto moved = [&](float by) {
    SkinPatch other = patch;
    other.skin.maps[0].values.pixels[texel] += by;
    return sum_of(DifferentiableSkinPatch(other).light()[0]);
  };
  const double difference = (moved(0.002f) - moved(-0.002f)) / 0.004;
  EXPECT_NEAR(static_cast<double>(gradient.maps[0].values.values[texel]), difference,
              0.01 * std::abs(difference));
}

// By diffusion, too: the same model, but for the junction, which is a sheet here. There it is a
// layer of 1 µm, of which a multipole makes half the absorption.
TEST(SkinPatch, UniformSkinReflectsAsTheSlabDoesByDiffusion) {
  SkinPatch patch = uniform_patch(16);
  patch.totals = OperatorTotals::diffusion;
  patch.transport.interlayer_bounces = 20;
  for (const double melanin : {0.005, 0.1})
    for (const double sheet : {0.0, 0.0175}) {
      patch.skin.skin.melanin = melanin;
      patch.skin.skin.junction_absorption = sheet;
      const SkinPatchResult result = render_skin_patch(patch);
      for (std::size_t b = 0; b < 2; ++b) {
        const LayerStack stack = skin_layer_stack(patch.skin.skin, patch.bands.wavelengths()[b]);
        const double slab = diffusion_totals(stack, {}).diffuse_reflectance;
        EXPECT_NEAR(result.bands[b].mean_reflectance, slab, sheet == 0.0 ? 1e-4 : 0.025 * slab);
        EXPECT_LT(result.bands[b].mean_reflectance, slab + 1e-4);
      }
    }
}

// Light on one half: photons count what leaves in the shade of the other.
TEST_F(PatchFiles, ShadeBesideAnEdgeOfLightIsThatOfPhotonsUnlessToldOtherwise) {
  constexpr int size = 64;
  SkinPatch patch = load(R"("width": 64, "height": 64, "mm_per_pixel": 0.05, "bands": [540],
      "skin": {"melanin": 0.01, "hemoglobin_dermis": 0.005, "junction_absorption": 0},
      "transport": {"interlayer_bounces": 4})");
  for (int y = 0; y < size; ++y)
    for (int x = size / 2; x < size; ++x)
      patch.light.pixels[static_cast<std::size_t>(y * size + x)] = 0.0f;
  const SkinPatchResult seen = render_skin_patch(patch);
  Patch twice{.stack = skin_layer_stack(patch.skin.skin, 540.0),
              .columns = 2 * size,
              .rows = 1,
              .texel = 0.05,
              .irradiance = std::vector<double>(2 * size, 0.0)};
  std::fill_n(twice.irradiance.begin(), size, 1.0);
  const PatchPhotons photons = trace_patch_photons(twice, {.photons = 1'000'000, .seed = 3});
  for (const int from_edge : {5, 6, 8, 10, 12}) {
    const auto k = static_cast<std::size_t>(from_edge);
    const Estimate a = photons.exitance[size + k], b = photons.exitance[2 * size - 1 - k];
    const double truth = 0.5 * (a.value + b.value);
    const double noise = 0.5 * std::hypot(a.standard_error, b.standard_error);
    const auto at =
        (32 * static_cast<std::size_t>(size) + size / 2 + k) * seen.image.channel_count();
    EXPECT_NEAR(seen.image.pixels[at], truth, 0.03 * truth + 2.5 * noise) << from_edge;
  }
}

TEST(SkinPatch, LightSpreadsIntoTheDark) {
  SkinPatch patch = uniform_patch(64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) patch.light.at(x, y)[0] = 0.0f;
  const Image image = render_skin_patch(patch).image;
  const std::size_t blue = *channel_index(image, "470nm"), red = *channel_index(image, "645nm");
  for (int x = 20; x < 60; ++x) EXPECT_GT(image.at(x, 30)[red], image.at(x - 1, 30)[red]);
  // Red light goes further.
  EXPECT_GT(image.at(27, 30)[red] / image.at(60, 30)[red],
            2.0f * image.at(27, 30)[blue] / image.at(60, 30)[blue]);
}

TEST(SkinPatch, FoldsOfSkinLetRedLightThrough) {
  SkinPatch patch = uniform_patch(16);
  patch.skin.skin.dermis_thickness = 1.0;
  const SkinPatchResult result = render_skin_patch(patch);
  const float* pixel = result.image.at(8, 8);
  const auto at = [&](const char* name) { return pixel[*channel_index(result.image, name)]; };
  EXPECT_GT(at("transmitted.645nm"), 2.0f * at("transmitted.470nm"));
  const double slab =
      adding_doubling(skin_layer_stack(patch.skin.skin, 645.0)).totals.transmittance;
  EXPECT_NEAR(at("transmitted.645nm"), slab, 0.1 * slab);  // light between layers is not even
}

TEST_F(PatchFiles, TakeTheirSizeFromTheFirstMapAndResampleTheOthers) {
  save_exr(make_image(20, 10, {"Y"}), folder_ / "a.exr");
  save_exr(make_image(8, 8, {"Y"}), folder_ / "b.exr");
  const SkinPatch patch = load(R"("mm_per_pixel": 0.1, "totals": "radiative_transfer",
    "skin": {"melanin": {"map": "a.exr"}, "carotene": {"map": "b.exr", "offset": 0.001}})");
  EXPECT_EQ(patch.width, 20);
  EXPECT_EQ(patch.height, 10);
  ASSERT_EQ(patch.warnings.size(), 1u);
  EXPECT_EQ(patch.warnings[0], "skin.carotene: 8 x 8 texels, resampled to 20 x 10");
  for (const float value : render_skin_patch(patch).image.pixels)
    EXPECT_TRUE(std::isfinite(value) && value >= -1e-3f);
}

// Ink that takes blue light only: blue is as of black ink, red as without any.
TEST_F(PatchFiles, JunctionsAbsorbByTheirSpectrum) {
  Image ink = make_image(16, 16, {"Y"});
  std::ranges::fill(ink.pixels, 1.0f);
  save_exr(ink, folder_ / "ink.exr");
  const auto reflectance = [&](double absorption, const std::string& more) {
    const auto bands =
        render_skin_patch(
            load(
                R"("mm_per_pixel": 0.1, "totals": "radiative_transfer", "bands": [450, 650], "skin": {
      "junction_absorption": {"map": "ink.exr", "scale": )" +
                std::to_string(absorption) + "}" + more + "}"))
            .bands;
    return std::array{bands[0].mean_reflectance, bands[1].mean_reflectance};
  };
  const auto none = reflectance(0.0, ""), black = reflectance(0.6, "");
  const auto orange = reflectance(0.6, R"(, "junction_spectrum": [[500, 1], [600, 0]])");
  EXPECT_LT(black[1], 0.6 * none[1]);
  EXPECT_LT(black[0], 0.9 * none[0]);
  EXPECT_NEAR(orange[0], black[0], 1e-6);
  EXPECT_NEAR(orange[1], none[1], 1e-6);
}

// A texture looks as it was made in even light, and knows nothing of what lies beside it.
TEST_F(PatchFiles, TexturesOfAlbedoShowTheirReflectanceInEvenLight) {
  Image texture = make_image(32, 32, {"645nm"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) texture.at(x, y)[0] = x < 16 ? 0.4f : 0.2f;
  save_exr(texture, folder_ / "albedo.exr");
  const std::string patch =
      R"("totals": "radiative_transfer", "mm_per_pixel": 0.1, "width": 32, "height": 32, "bands": [645],
    "skin": {}, "albedo": "albedo.exr")";
  const Image even = render_skin_patch(load(patch)).image;
  for (int x = 0; x < 32; ++x) EXPECT_NEAR(even.at(x, 5)[0], x < 16 ? 0.4 : 0.2, 2e-4);
  SkinPatch striped = load(patch + R"(, "light": {"stripes": {"period": 3.2, "width": 1.0}})");
  const Image with = render_skin_patch(striped).image;
  striped.albedo = {};
  const Image without = render_skin_patch(striped).image;
  for (int x = 0; x < 16; ++x)
    EXPECT_NEAR(with.at(x, 5)[0] / with.at(x + 16, 5)[0],
                2.0f * without.at(x, 5)[0] / without.at(x + 16, 5)[0], 1e-3);
  EXPECT_NE(message_of(R"("mm_per_pixel": 0.1, "width": 8, "height": 8, "bands": [500], "skin": {},
    "albedo": "albedo.exr")")
                .find("no channel \"500nm\""),
            std::string::npos);
}

TEST_F(PatchFiles, CutLightToWindowsAndStripes) {
  const std::string patch = R"("mm_per_pixel": 0.1, "width": 80, "height": 40, "skin": {}, )";
  const auto total = [&](const std::string& light) {
    const Image image = load(patch + "\"light\": " + light).light;
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
  };
  EXPECT_NEAR(total("{}"), 3200.0, 1e-3);
  EXPECT_NEAR(total(R"({"irradiance": 2.5})"), 8000.0, 1e-2);
  EXPECT_NEAR(total(R"({"window": [3.05, 2.0]})"), 30.5 * 20.0, 1e-2);
  EXPECT_NEAR(total(R"({"stripes": {"period": 2.0, "width": 0.5}})"), 800.0, 1e-2);
  EXPECT_NEAR(total(R"({"stripes": {"period": 1.0, "width": 0.3, "angle": 30}})"), 960.0, 15.0);
}

TEST_F(PatchFiles, BouncesMayDifferByBand) {
  const std::string of_two =
      R"("mm_per_pixel": 0.1, "width": 8, "height": 8, "skin": {}, "bands": [450, 650], )";
  const SkinPatch patch = load(of_two + R"("transport": {"interlayer_bounces": [1, 4]})");
  const SkinPatchResult result = render_skin_patch(patch);
  EXPECT_EQ(result.bands[0].interlayer_bounces, 1);
  EXPECT_EQ(result.bands[1].interlayer_bounces, 4);
  EXPECT_NE(
      message_of(of_two + R"("transport": {"interlayer_bounces": [1]})").find("interlayer_bounces"),
      std::string::npos);
  EXPECT_NE(message_of(of_two + R"("transport": {"interlayer_bounces": [1, 2.5]})")
                .find("interlayer_bounces[1]"),
            std::string::npos);
}

TEST_F(PatchFiles, AreRefusedInOneLineThatSaysWhere) {
  const std::string size = R"("mm_per_pixel": 0.1, "width": 8, "height": 8, )";
  EXPECT_NE(message_of(R"("skin": {})").find("mm_per_pixel"), std::string::npos);
  EXPECT_NE(message_of(R"("mm_per_pixel": 0.1, "skin": {})").find("width"), std::string::npos);
  EXPECT_NE(message_of(size + R"("skin": {}, "bands": "rgb")").find("bands"), std::string::npos);
  EXPECT_NE(message_of(size + R"("skin": {}, "bands": [500, 400])").find("bands"),
            std::string::npos);
  EXPECT_NE(message_of(size + R"("skin": {}, "light": {"theta": 90})").find("theta"),
            std::string::npos);
  EXPECT_NE(
      message_of(size +
                 R"("skin": {}, "transport": {"interlayer_bounces": 2, "energy_threshold": 0.9})")
          .find("energy_threshold"),
      std::string::npos);
  EXPECT_NE(message_of(size + R"("skin": {}, "lihgt": {})").find("light"), std::string::npos);
  for (const std::string& text : {message_of(R"("skin": 3)"), message_of(size + R"("skin": [])")})
    EXPECT_EQ(text.find('\n'), std::string::npos);
}

// The same files as the schemas are held against.
TEST(SkinPatch, DecodesTheCorpusOfGoodAndBadFiles) {
  const fs::path inputs = fs::path(LAMINA_SOURCE_DIR) / "tests/inputs";
  const auto check = [&](const char* kind, const auto& load) {
    for (const char* quality : {"good", "bad"})
      for (const auto& entry : fs::directory_iterator(inputs / kind / quality)) {
        if (entry.path().extension() != ".json") continue;
        std::string message;
        try {
          load(entry.path());
        } catch (const Error& error) {
          message = error.what();
        }
        EXPECT_EQ(message.empty(), quality == std::string("good")) << entry.path() << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << entry.path();
      }
  };
  check("patch", [](const fs::path& file) { (void)load_skin_patch(file); });
  check("maps", [](const fs::path& file) { (void)make_skin_maps(load_skin_map_recipe(file)); });
}

// Eight bands instead of many, [Donner2008] §7: within 1 %, on skins that the weights were not made
// for, in 8 nm steps.
TEST(SkinPatch, EightBandsShowTheColorsOfSkinWithinOnePercent) {
  const BandSet few = default_spectral_bands();
  std::vector<double> wavelengths;
  for (int nm = 380; nm <= 780; nm += 8) wavelengths.push_back(nm);
  const BandSet many(wavelengths);
  const BandWeights few_weights = make_skin_band_weights(few, {});
  const BandWeights many_weights = make_band_weights(many);
  const BandWeights blind_weights = make_band_weights(few);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0.0;
    for (const auto& weight : few_weights) sum += weight[c];
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
  double blind_error = 0.0;
  for (const double melanin : {0.006, 0.03, 0.12})
    for (const double blood : {0.004, 0.02})
      for (const double saturation : {0.45, 0.9}) {
        const SkinParameters skin{.melanin = melanin,
                                  .hemoglobin_dermis = blood,
                                  .carotene = 0.002,
                                  .saturation_epidermis = saturation,
                                  .saturation_dermis = saturation};
        const auto reflectance = [&](const BandSet& bands) {
          std::vector<double> values;
          for (const double nm : bands.wavelengths())
            values.push_back(adding_doubling(skin_layer_stack(skin, nm), {}, {.accuracy = 1e-4})
                                 .totals.diffuse_reflectance);
          return values;
        };
        const LinearSrgb wanted = linear_srgb(many_weights, reflectance(many));
        const std::vector<double> seen = reflectance(few);
        const LinearSrgb ours = linear_srgb(few_weights, seen);
        const LinearSrgb blind = linear_srgb(blind_weights, seen);
        double error = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          error = std::max(error, std::abs(ours[c] / wanted[c] - 1.0));
          blind_error = std::max(blind_error, std::abs(blind[c] / wanted[c] - 1.0));  // of all
        }
        EXPECT_LT(error, 0.011) << melanin << " " << blood << " " << saturation;
      }
  EXPECT_GT(blind_error, 0.03);
}

}  // namespace
}  // namespace lamina
