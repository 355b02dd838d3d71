// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/patch_inversion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/skin/acquire/inversion/patch_tiles.h"
#include "lamina/skin/fit/skin/skin_fit.h"
#include "skin/acquire/inversion/synthetic_patch.h"

namespace lamina {
namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

// Skin of the usual constants in three bands, in which three numbers show; the closed form's
// totals, which take little time.
SyntheticSetup small_setup() {
  return {.size = 32,
          .window = 0.0,
          .tape = 0,
          .wavelengths = {420.0, 520.0, 580.0},
          .skin = {},
          .totals = OperatorTotals::diffusion,
          .is_finer = false};
}

InversionModel small_model() {
  InversionModel model;
  model.numbers = {"melanin", "hemoglobin_epidermis", "hemoglobin_dermis"};
  model.skin.melanin_blend = 0.65;
  model.skin.carotene = 0.003;
  model.totals = OperatorTotals::diffusion;
  return model;
}

struct SmallPatch {
  SyntheticPatch patch;
  InversionTables tables;
};
const SmallPatch& small_patch() {
  static const SmallPatch made = [] {
    SyntheticPatch patch = make_synthetic_patch(small_setup());
    InversionTables tables = make_inversion_tables(patch.capture, small_model());
    return SmallPatch{std::move(patch), std::move(tables)};
  }();
  return made;
}

MapError error_of(const SyntheticPatch& patch, const NumberMap& map, std::size_t truth) {
  return map_error(
      patch.capture, [&](std::size_t t) { return static_cast<double>(map.value.values[t]); },
      [&](std::size_t t) { return static_cast<double>(patch.truth[truth].values[t]); });
}

TEST(PatchInversion, FindsTheMapsThatAPhotographWasMadeOf) {
  const auto& [patch, tables] = small_patch();
  const InversionResult result = invert_patch(patch.capture, tables, {.most_forwards = 40.0});
  EXPECT_LT(result.history.back().in_deviations, 2.0);
  ASSERT_EQ(result.numbers.size(), 3u);
  const MapError melanin = error_of(patch, result.numbers[0], 0);
  EXPECT_EQ(result.numbers[0].name, "melanin");
  EXPECT_GT(melanin.correlation, 0.98);
  EXPECT_GT(error_of(patch, result.numbers[2], 3).correlation, 0.95);
  // Each texel by itself takes the light of freckles for that of skin beside them.
  const InversionResult alone = invert_patch(patch.capture, tables, {.is_by_texel = true});
  EXPECT_LT(melanin.relative, 0.8 * error_of(patch, alone.numbers[0], 0).relative);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t t = 0; t < 32 * 32; t += 37) {
      const float predicted =
          patch.capture.images[i].reflected.values[t] - result.residual[i].values[t];
      EXPECT_NEAR(predicted, patch.clean[i].values[t], 0.02f);
    }
}

// Uniform skin under uniform light: each texel is a spectrum that fit_skin fits.
TEST(PatchInversion, OfUniformSkinIsTheFitOfASpectrum) {
  InversionModel model = small_model();
  model.numbers = {"melanin", "hemoglobin_dermis"};
  model.totals = OperatorTotals::radiative_transfer;
  SkinParameters skin = model.skin;
  skin.melanin = 0.03;
  skin.hemoglobin_dermis = 0.02;
  const SkinReflectanceTable table({420.0, 580.0}, {}, skin_fit_range(skin));
  const std::vector<double> reflected = table.reflectance(skin);
  PatchCapture capture{.width = 8,
                       .height = 8,
                       .mm_per_texel = 0.3,
                       .wavelengths = table.wavelengths(),
                       .lights = {make_plane(8, 8, 1.0f)}};
  for (std::size_t w = 0; w < 2; ++w)
    capture.images.push_back({make_plane(8, 8, static_cast<float>(reflected[w])),
                              make_plane(8, 8, 0.002f),
                              w == 0 ? std::vector{1.0, 0.0} : std::vector{0.0, 1.0}});
  std::vector<SkinFitNumber> numbers;
  for (const SkinFitNumber& number : skin_fit_numbers(model.skin))
    if (std::ranges::find(model.numbers, number.parameter.name) != model.numbers.end())
      numbers.push_back(number);
  const SkinFit fit = fit_skin(table, {reflected, {0.002, 0.002}, {}, false}, model.skin, numbers);
  const InversionTables tables = make_inversion_tables(capture, model);
  InversionModel alone = model;
  alone.has_transport = false;
  for (const bool has_transport : {false, true}) {
    const InversionResult result =
        has_transport ? invert_patch(capture, tables)
                      : invert_patch(capture, make_inversion_tables(capture, alone),
                                     {.is_by_texel = true, .deviation_samples = 1});
    for (std::size_t n = 0; n < 2; ++n) {
      if (!has_transport) {
        EXPECT_NEAR(
            result.numbers[n].deviation.values[9] / fit.fit.parameters[n].standard_deviation, 1.0,
            0.02);
      }
      for (const float value : result.numbers[n].value.values)
        EXPECT_NEAR(value / fit.fit.parameters[n].value, 1.0, has_transport ? 0.03 : 2e-3)
            << result.numbers[n].name;
    }
  }
}

// A window of light: what lies in the dark has no part in it. Texels that are not known may hold
// anything, and get values of those around.
TEST(PatchInversion, LeavesOutWhatIsNotKnown) {
  SyntheticPatch patch = small_patch().patch;
  for (int y = 12; y < 16; ++y)
    for (int x = 12; x < 16; ++x)
      for (PatchImage& image : patch.capture.images) {
        const auto t = static_cast<std::size_t>(32 * y + x);
        image.deviation.values[t] = unknown;
        image.reflected.values[t] = std::numeric_limits<float>::quiet_NaN();
      }
  const InversionResult result =
      invert_patch(patch.capture, small_patch().tables, {.most_forwards = 30.0});
  EXPECT_LT(result.history.back().in_deviations, 2.5);
  const std::vector<float>& melanin = result.numbers[0].value.values;
  EXPECT_TRUE(std::ranges::all_of(melanin, [](float value) { return std::isfinite(value); }));
  EXPECT_EQ(result.residual[0].values[32 * 13 + 13], 0.0f);
  EXPECT_GT(error_of(patch, result.numbers[0], 0).correlation, 0.97);
}

TEST(PatchInversion, HandsOverTheBestSoFarWhenInterrupted) {
  const auto& [patch, tables] = small_patch();
  int calls = 0;
  const InversionResult result =
      invert_patch(patch.capture, tables, {}, [&](double) { return ++calls < 12; });
  EXPECT_EQ(result.stop, InversionStop::interrupted);
  const InversionResult at_once =
      invert_patch(patch.capture, tables, {}, [](double) { return false; });
  EXPECT_EQ(at_once.stop, InversionStop::interrupted);
  EXPECT_EQ(at_once.numbers.size(), 3u);
  // It goes on from there.
  InversionOptions on{.most_forwards = 20.0};
  for (const NumberMap& map : result.numbers) on.start.push_back(map.value);
  const InversionResult resumed = invert_patch(patch.capture, tables, on);
  EXPECT_NEAR(resumed.history.front().objective / result.history.back().objective, 1.0, 0.02);
  EXPECT_LT(resumed.history.back().objective, result.history.back().objective);
}

// A hair or a glint in one band.
TEST(PatchInversion, LeavesFarResidualsAloneIfAskedTo) {
  SyntheticPatch patch = small_patch().patch;
  for (std::size_t t = 100; t < 32 * 32; t += 97)
    patch.capture.images[2].reflected.values[t] +=
        40.0f * patch.capture.images[2].deviation.values[t];
  InversionOptions options{.smoothness = {20.0, 50.0, 50.0}, .most_forwards = 20.0};
  const auto error = [&] {
    return error_of(patch, invert_patch(patch.capture, small_patch().tables, options).numbers[2], 3)
        .relative;
  };
  const double plain = error();
  options.robust_limit = 3.0;
  EXPECT_LT(error(), 0.9 * plain);
}

// What draws say of errors is as large as errors are.
TEST(PatchInversion, KnowsItsErrors) {
  const auto& [patch, tables] = small_patch();
  const InversionResult result = invert_patch(
      patch.capture, tables,
      {.smoothness = {20.0, 50.0, 50.0}, .most_forwards = 25.0, .deviation_samples = 4});
  ASSERT_EQ(result.correlation.rows, 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(result.correlation(n, n), 1.0, 1e-12);
    EXPECT_LT(std::abs(result.correlation(n, (n + 1) % 3)), 1.0);
    for (std::size_t t = 0; t < 32 * 32; ++t) {
      const NumberMap& map = result.numbers[n];
      ASSERT_GT(map.deviation.values[t], 0.0f);
      ASSERT_NEAR(map.prior_share.values[t] * wide_deviation, map.deviation.values[t], 1e-5f);
    }
  }
  // Blood of the dermis lies deeper, and shows less.
  EXPECT_LT(result.numbers[0].deviation.values[528], result.numbers[2].deviation.values[528]);
  const FitParameter& melanin = tables.numbers[0].parameter;
  double squares = 0.0, expected = 0.0;
  for (std::size_t t = 0; t < 32 * 32; ++t) {
    const auto at = [&](const Plane& plane) {
      return fit_coordinate(melanin, static_cast<double>(plane.values[t]));
    };
    squares += std::pow(at(result.numbers[0].value) - at(patch.truth[0]), 2);
    expected += std::pow(static_cast<double>(result.numbers[0].deviation.values[t]), 2);
  }
  EXPECT_LT(squares / expected, 9.0);  // carotene and blend vary, of which nothing is known
  EXPECT_GT(squares / expected, 0.3);
}

/// Six bands, in which all five numbers that vary show, with noise of so many stated deviations,
/// [image].
SmallPatch understated_patch(const std::vector<double>& factors) {
  SyntheticSetup setup = small_setup();
  setup.wavelengths = {400.0, 420.0, 480.0, 520.0, 580.0, 700.0};
  SyntheticPatch patch = make_synthetic_patch(setup);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    PatchImage& image = patch.capture.images[i];
    for (std::size_t t = 0; t < image.reflected.values.size(); ++t)
      image.reflected.values[t] =
          patch.clean[i].values[t] +
          static_cast<float>(factors[i] * normal(random)) * image.deviation.values[t];
  }
  InversionModel model = small_model();
  model.numbers = {"melanin", "melanin_blend", "hemoglobin_epidermis", "hemoglobin_dermis",
                   "carotene"};
  InversionTables tables = make_inversion_tables(patch.capture, model);
  return {std::move(patch), std::move(tables)};
}

/// The share of coordinates of all maps that lie within so many standard deviations of the truth.
double coverage(const SmallPatch& made, const InversionResult& result, double deviations) {
  double covered = 0.0, count = 0.0;
  for (std::size_t n = 0; n < result.numbers.size(); ++n) {
    const FitParameter& parameter = made.tables.numbers[n].parameter;
    const NumberMap& map = result.numbers[n];
    for (std::size_t t = 0; t < map.value.values.size(); ++t) {
      const auto at = [&](const Plane& plane) {
        return fit_coordinate(parameter, static_cast<double>(plane.values[t]));
      };
      const auto deviation = static_cast<double>(map.deviation.values[t]);
      covered += std::abs(at(map.value) - at(made.patch.truth[n])) < deviations * deviation;
      count += 1.0;
    }
  }
  return covered / count;
}

// Noise is understated by three in all images but one, and the maps have edges that smoothness
// does not know. What was to be spent is spent before errors grow: the maps follow all the same.
TEST(PatchInversion, ErrorsGrowToWhatIsLeft) {
  const std::vector<double> factors = {3.0, 3.0, 3.0, 1.0, 3.0, 3.0};
  const SmallPatch made = understated_patch(factors);
  const InversionResult result =
      invert_patch(made.patch.capture, made.tables, {.deviation_samples = 4});
  const std::vector<double> chi_squared = chi_squared_of(result.misfit);
  ASSERT_EQ(result.error_growth.size(), factors.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    EXPECT_NEAR(std::sqrt(chi_squared[i]), result.error_growth[i], 0.02 * factors[i]);
    // Freckles of edges finer than a texel are left by the smoothness, and count as noise.
    EXPECT_NEAR(result.error_growth[i] / factors[i], factors[i] > 1.0 ? 1.0 : 1.4, 0.3) << i;
  }
  EXPECT_NEAR(coverage(made, result, 1.0), 0.683, 0.08);
  EXPECT_NEAR(coverage(made, result, 2.0), 0.954, 0.05);
}

// Noise as it is stated; freckles of edges finer than a texel are left by the smoothness, with up
// to twice its deviation, and errors that grow to that cover the truth.
TEST(PatchInversion, ErrorsGrowToWhatSmoothnessLeaves) {
  const SmallPatch made = understated_patch({1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
  const InversionResult result =
      invert_patch(made.patch.capture, made.tables, {.deviation_samples = 4});
  for (const double growth : result.error_growth) EXPECT_LT(growth, 2.2);
  EXPECT_NEAR(coverage(made, result, 1.0), 0.66, 0.12);
  RecordProperty("coverage", std::to_string(coverage(made, result, 1.0)));
}

TEST(PatchInversion, OfTilesIsThatOfTheWhole) {
  const auto& [patch, tables] = small_patch();
  InversionOptions options{.smoothness = {20.0, 50.0, 50.0}, .most_forwards = 25.0};
  const TileOptions tiling{.side = 16, .halo = 2.5};
  const std::vector<PatchTile> tiles = patch_tiles(32, 32, patch.capture.mm_per_texel, tiling);
  ASSERT_EQ(tiles.size(), 4u);
  InversionResult placed = invert_patch(patch.capture, tables, options);
  const InversionResult whole = placed;
  put_tile(32, 32, tiles[3],
           invert_tile(part_of(patch.capture, tiles[3].inverted), tables, tiles[3], options),
           placed);
  for (const std::size_t n : {0u, 2u}) {
    const MapError error = map_error(
        patch.capture,
        [&](std::size_t t) { return static_cast<double>(placed.numbers[n].value.values[t]); },
        [&](std::size_t t) { return static_cast<double>(whole.numbers[n].value.values[t]); });
    EXPECT_LT(error.relative, n == 0 ? 0.03 : 0.05) << placed.numbers[n].name;
    EXPECT_GT(error.relative, 0.0);
  }
  options.most_forwards = 5.0;
  const InversionResult tiled = invert_tiles(patch.capture, tables, tiling, options);
  ASSERT_EQ(tiled.numbers[0].value.width, 32);
  EXPECT_GT(error_of(patch, tiled.numbers[0], 0).correlation, 0.6);
  // Asked to stop, tiles that are left have what they were to go on from.
  for (const NumberMap& map : whole.numbers) options.start.push_back(map.value);
  const InversionResult stopped =
      invert_tiles(patch.capture, tables, tiling, options, [](double) { return false; });
  EXPECT_EQ(stopped.stop, InversionStop::interrupted);
  for (std::size_t n = 0; n < 3; ++n)
    for (const std::size_t t : {31u, 32u * 31u, 32u * 32u - 1u})
      EXPECT_NEAR(stopped.numbers[n].value.values[t] / options.start[n].values[t], 1.0f, 1e-5f);
  EXPECT_TRUE(stopped.numbers[0].deviation.values.empty());
  options.start.clear();
  // Tiles are as large as memory allows, but not so small that halos are most of them.
  EXPECT_NEAR(std::pow(side_of_tiles(1e9, 6, 0.1, 2.5) + 50.0, 2) * 6.0 * inversion_bytes_per_texel,
              1e9, 1e7);
  EXPECT_EQ(side_of_tiles(1e6, 31, 0.02, 2.5), 64);
  // A tile of which nothing is known.
  PatchCapture dark = patch.capture;
  for (Plane& light : dark.lights) std::ranges::fill(light.values, 0.0f);
  const PatchTile tile{{0, 0, 8, 4}, {0, 0, 16, 16}};
  const InversionResult nothing = invert_tile(part_of(dark, tile.inverted), tables, tile, options);
  EXPECT_EQ(nothing.numbers[1].value.height, 4);
  EXPECT_TRUE(nothing.residual.empty());
  EXPECT_THROW((void)patch_tiles(32, 32, 0.1, {.side = 0}), InvalidInput);
}

// Red, green and blue are sums over wavelengths; strips of light are one more pattern.
TEST(PatchInversion, TakesWideBandsAndPatterns) {
  SyntheticSetup setup = small_setup();
  setup.sensors = {{0.8, 0.2, 0.0}, {0.1, 0.6, 0.3}, {0.0, 0.3, 0.7}};
  setup.strips = {0.0, 2.5};
  const SyntheticPatch patch = make_synthetic_patch(setup);
  ASSERT_EQ(patch.capture.images.size(), 6u);
  const InversionResult result =
      invert_patch(patch.capture, small_patch().tables, {.most_forwards = 60.0});
  EXPECT_LT(result.history.back().in_deviations, 6.0);  // carotene and blend vary, too
  EXPECT_GT(error_of(patch, result.numbers[0], 0).correlation, 0.93);
}

TEST(PatchInversion, SaysWhatIsWrongWithACapture) {
  const auto& [patch, tables] = small_patch();
  const auto message = [&](const std::function<void(PatchCapture&)>& spoil) -> std::string {
    PatchCapture capture = patch.capture;
    spoil(capture);
    try {
      check_capture(capture);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](PatchCapture&) {}), "");
  EXPECT_EQ(message([](PatchCapture& c) { c.images.clear(); }), "capture: must have images");
  EXPECT_EQ(message([](PatchCapture& c) { c.images[1].reflected = make_plane(8, 8); }),
            "image 1: must be 32 x 32 texels, but is 8 x 8");
  EXPECT_EQ(message([](PatchCapture& c) {
              c.images[0].sensor = {0.5, std::nan(""), 0.5};
            }),
            "image 0: weights of the sensor must be finite, but is nan");
  EXPECT_EQ(message([](PatchCapture& c) {
              c.images[0].sensor = {0.5, 0.25, 0.0};
            }),
            "image 0: weights of the sensor must sum to 1, but is 0.75");
  EXPECT_EQ(message([](PatchCapture& c) { c.images[2].deviation.values[33] = 0.0f; }),
            "image 2 at texel (1, 1): deviation must be > 0, but is 0");
  EXPECT_EQ(message([](PatchCapture& c) { c.images[2].reflected.values[3] = -0.5f; }),
            "image 2 at texel (3, 0): reflected light must be finite, and >= 0 but for noise, but "
            "is -0.5");
  EXPECT_EQ(message([](PatchCapture& c) { c.images[2].reflected.values[3] = -0.001f; }), "");
  PatchCapture part = part_of(patch.capture, {8, 4, 5, 5});
  EXPECT_EQ(check_part(part, 8, 4), 75u);
  part.lights[0].values[7] = -1.0f;
  try {
    (void)check_part(part, 8, 4);
    ADD_FAILURE();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "light 0 at texel (10, 5): must be finite and >= 0, but is -1");
  }
  EXPECT_EQ(message([](PatchCapture& c) {
              for (PatchImage& image : c.images) std::ranges::fill(image.deviation.values, unknown);
            }),
            "capture: must have a texel that is lit and known");
  InversionModel model = small_model();
  for (const char* name : {"melanine", "scattering_scale", "hemoglobin_dermis"}) {
    model.numbers = {name, "hemoglobin_dermis"};
    EXPECT_THROW((void)make_inversion_tables(patch.capture, model), InvalidInput) << name;
  }
  model.numbers = InversionModel{}.numbers;  // five from three images
  EXPECT_THROW((void)make_inversion_tables(patch.capture, model), InvalidInput);
  EXPECT_THROW((void)invert_patch(patch.capture, tables, {.smoothness = {1.0}}), InvalidInput);
  EXPECT_THROW((void)invert_patch(patch.capture, tables, {.tolerance = -1.0}), InvalidInput);
}

// A table that is handed down is taken as it is: none is made beside it.
TEST(InversionTables, TakeTheReflectanceThatIsHandedDown) {
  const PatchCapture& capture = small_patch().patch.capture;
  InversionModel model = small_model();
  model.has_transport = false;
  const auto reflectance = [&] {
    return make_inversion_tables(capture, model).reflectance->at(0, {1.0, 0.1}).reflectance;
  };
  const auto table = [&](std::vector<double> wavelengths, Incidence incidence) {
    return std::make_shared<const SkinReflectanceTable>(std::move(wavelengths), incidence,
                                                        skin_fit_range(model.skin));
  };
  const double own = reflectance();
  model.reflectance = table(capture.wavelengths, {.theta = capture.theta});
  EXPECT_EQ(reflectance(), own);
  model.reflectance = table(capture.wavelengths, {.is_diffuse = true});
  EXPECT_NE(reflectance(), own);
  model.reflectance = table({500.0}, {});
  EXPECT_THROW((void)reflectance(), InvalidInput);
}

TEST(LocalReflectance, IsThatOfTheTableOfSkin) {
  const std::vector<double> wavelengths = {420.0, 650.0};
  const SkinReflectanceTable table(wavelengths, {}, skin_fit_range({}));
  const LocalReflectance local(table, {});
  for (const double melanin : {0.001, 0.01, 0.08, 0.3})
    for (const double blood : {0.0005, 0.01, 0.06}) {
      SkinParameters skin;
      skin.melanin = melanin;
      skin.hemoglobin_dermis = blood;
      for (std::size_t w = 0; w < 2; ++w) {
        const std::array<double, 2> sigma_a = {epidermis_absorption(skin, wavelengths[w]),
                                               dermis_absorption(skin, wavelengths[w])};
        const LocalReflectance::Value value = local.at(w, sigma_a);
        EXPECT_NEAR(value.reflectance / table.reflectance_at(w, skin), 1.0, 2e-4);
        for (std::size_t l = 0; l < 2; ++l) {
          auto above = sigma_a, below = sigma_a;
          above[l] *= 1.0001;
          below[l] /= 1.0001;
          const double slope = (local.at(w, above).reflectance - local.at(w, below).reflectance) /
                               (above[l] - below[l]);
          EXPECT_NEAR(value.by_sigma_a[l] / slope, 1.0, 1e-4);
        }
      }
    }
}

}  // namespace
}  // namespace lamina
