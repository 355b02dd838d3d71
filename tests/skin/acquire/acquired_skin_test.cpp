// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/acquired_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/io/json_input.h"
#include "lamina/skin/acquire/acquisition_check.h"
#include "lamina/skin/acquire/bands/band_choice.h"
#include "lamina/skin/acquire/files/acquired_files.h"
#include "lamina/skin/acquire/patch_acquisition.h"
#include "lamina/skin/acquire/skin_acquisition.h"
#include "lamina/skin/maps/files/skin_maps_file.h"
#include "lamina/skin/maps/skin_maps.h"

namespace lamina {
namespace {

/// Three bands, for which a table is quick to make, of skins that the maps must find again.
struct Made {
  Capture capture;
  std::vector<SkinParameters> skins;  ///< [pixel]
  SkinReflectanceTable table{{450.0, 550.0, 650.0}, {.is_diffuse = true}, skin_fit_range({})};

  Made() {
    capture.name = "made";
    capture.wavelengths = table.wavelengths();
    capture.sensor = DenseMatrix(3, 3);
    for (std::size_t b = 0; b < 3; ++b) capture.sensor(b, b) = 1.0;
    capture.errors.assign(3, 0.01);
    capture.incidence.is_diffuse = true;
    capture.mm_per_pixel = 0.5;
    capture.population = forearm_population();
    std::ranges::fill(capture.population->missed, 0.0);
    capture.population_name = "forearms";
    const std::vector<SkinFitNumber> all = skin_fit_numbers({});
    capture.numbers = {all[0], all[3], all[5]};  // melanin, blood of the dermis, saturation
    capture.reflectance = make_image(6, 4, {"450nm", "550nm", "650nm"});
    for (std::size_t i = 0; i < 24; ++i) {
      SkinParameters skin;
      skin.melanin = 0.006 * std::pow(1.08, static_cast<double>(i % 6));
      skin.hemoglobin_dermis = 0.004 * std::pow(1.2, static_cast<double>(i / 6));
      skins.push_back(skin);
      const std::vector<double> bands = table.reflectance(skin);
      for (std::size_t b = 0; b < 3; ++b)
        capture.reflectance.pixels[3 * i + b] = static_cast<float>(bands[b]);
    }
    capture.mask = make_pixel_mask(6, 4);
    capture.mask.mark(1, PixelFault::excluded);
    capture.mask.mark(2, PixelFault::saturated);
    std::ranges::copy(std::array{0.1f, 0.5f, 0.1f}, capture.reflectance.at(3, 0));  // green
  }
};
const Made& made() {
  static const Made each;
  return each;
}
const AcquiredSkin& acquired() {
  static const AcquiredSkin skin =
      acquire_pixels(made().capture, lookup_of(made().capture, made().table));
  return skin;
}

TEST(AcquiredSkin, FindsWhatSkinIsMadeOf) {
  for (std::size_t i = 6; i < 24; ++i) {
    const auto off = [&](std::size_t number) {
      const AcquiredNumber& each = acquired().numbers[number];
      const FitParameter& parameter = each.number.parameter;
      return std::abs(fit_coordinate(parameter, static_cast<double>(each.values.pixels[i])) -
                      fit_coordinate(parameter, made().skins[i].*each.number.values[0])) /
             static_cast<double>(each.deviations.pixels[i]);
    };
    for (std::size_t n = 0; n < 3; ++n) EXPECT_LT(off(n), 3.0) << "pixel " << i;
  }
  EXPECT_LT(acquired().numbers[0].prior_share, 0.5);
}

TEST(AcquiredSkin, CountsWhatIsNoSkin) {
  EXPECT_EQ(acquired().counts, (std::array<std::size_t, pixel_kinds>{21, 2, 1}));
  EXPECT_EQ(acquired().kinds[1], PixelKind::unused);
  EXPECT_EQ(acquired().kinds[2], PixelKind::unused);
  EXPECT_EQ(acquired().kinds[3], PixelKind::not_skin);
  for (const AcquiredNumber& number : acquired().numbers)
    for (const std::size_t i : {1, 2, 3}) {
      EXPECT_FLOAT_EQ(number.deviations.pixels[i], static_cast<float>(number.prior_deviation));
      EXPECT_TRUE(std::isfinite(number.values.pixels[i]));
    }
}

TEST(AcquiredSkin, RefusesWhatHasNoSkin) {
  Capture dark = made().capture;
  std::ranges::fill(dark.reflectance.pixels, 0.0f);
  const SkinLookup table = lookup_of(made().capture, made().table);
  try {
    (void)acquire_pixels(dark, table);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "capture: no pixel has a color of skin: of 24, 2 are not used, 22 no skin");
  }
}

// Independent: the change of a band, by hand, moves the numbers as the check says.
TEST(AcquisitionCheck, SaysHowFarMapsHangOnTheCalibration) {
  const AcquisitionCheck check = check_acquisition(made().capture, acquired(), made().table);
  for (const double residual : check.residual) EXPECT_LT(residual, 0.02);
  EXPECT_FALSE(check.mean_difference);
  Capture brighter = made().capture;
  for (std::size_t i = 0; i < 24; ++i) brighter.reflectance.pixels[3 * i + 1] *= 1.02f;
  const AcquiredSkin moved = acquire_pixels(brighter, lookup_of(brighter, made().table));
  for (std::size_t n = 0; n < 3; ++n) {
    const FitParameter& parameter = acquired().numbers[n].number.parameter;
    std::vector<double> changes;
    for (std::size_t i = 6; i < 24; ++i)
      changes.push_back(
          fit_coordinate(parameter, static_cast<double>(moved.numbers[n].values.pixels[i])) -
          fit_coordinate(parameter, static_cast<double>(acquired().numbers[n].values.pixels[i])));
    std::ranges::sort(changes);
    EXPECT_NEAR(check.by_calibration(1, n), changes[changes.size() / 2], 0.03);
  }
}

TEST(AcquisitionCheck, CarriesTheErrorsOfGainsOn) {
  const AcquisitionCheck check = check_acquisition(made().capture, acquired(), made().table);
  Capture unsure = made().capture;
  unsure.gain_covariance = DenseMatrix(3, 3);
  unsure.gain_covariance(1, 1) = 0.04 * 0.04;
  AcquiredSkin skin = acquired();
  add_gain_errors(unsure, check, skin);
  for (std::size_t n = 0; n < 3; ++n) {  // 4 % of green is twice the change of 2 %
    const double expected =
        std::min(skin.numbers[n].prior_deviation,
                 std::hypot(static_cast<double>(acquired().numbers[n].deviations.pixels[20]),
                            2.0 * check.by_calibration(1, n)));
    EXPECT_NEAR(static_cast<double>(skin.numbers[n].deviations.pixels[20]), expected, 1e-5);
    EXPECT_GE(skin.numbers[n].prior_share, acquired().numbers[n].prior_share);
  }
  AcquiredSkin same = acquired();
  add_gain_errors(made().capture, check, same);
  EXPECT_EQ(same.numbers[0].deviations.pixels, acquired().numbers[0].deviations.pixels);
}

// Without a population and without noise: the numbers themselves.
TEST(PatchAcquisition, FindsNumbersOfPixelsOnTheirOwn) {
  Capture exact = made().capture;
  exact.population.reset();
  exact.incidence = {.theta = 57.0 * std::numbers::pi / 180.0};
  const SkinReflectanceTable table(exact.wavelengths, exact.incidence, skin_fit_range({}));
  for (std::size_t i = 0; i < 24; ++i) {
    const std::vector<double> bands = table.reflectance(made().skins[i]);
    for (std::size_t b = 0; b < 3; ++b)
      exact.reflectance.pixels[3 * i + b] = static_cast<float>(bands[b]);
  }
  exact.deviation = exact.reflectance;
  for (float& deviation : exact.deviation.pixels) deviation *= 0.01f;
  const AcquiredSkin skin =
      acquire_patch(exact, {.has_transport = false, .inversion = {.deviation_samples = 0}});
  ASSERT_EQ(skin.numbers.size(), 3U);
  for (std::size_t i = 6; i < 24; ++i)
    for (const AcquiredNumber& number : skin.numbers)
      EXPECT_NEAR(
          static_cast<double>(number.values.pixels[i]) / (made().skins[i].*number.number.values[0]),
          1.0, 0.05)
          << number.number.parameter.name << " at " << i;
  EXPECT_EQ(skin.counts[static_cast<std::size_t>(PixelKind::unused)], 2U);
  for (std::size_t i = 3 * 6; i < skin.predicted.pixels.size(); ++i)
    EXPECT_NEAR(skin.predicted.pixels[i], exact.reflectance.pixels[i], 2e-3f);
  EXPECT_FALSE(skin.inversion->has_transport);
}

/// Skins of a population in some bands with noise of so many stated deviations.
struct UnderstatedPixels {
  Capture capture = made().capture;
  std::vector<SkinParameters> skins;

  UnderstatedPixels(std::vector<double> nm, const std::vector<std::size_t>& numbers,
                    const std::vector<double>& factors) {
    constexpr int side = 24;
    const std::size_t bands = nm.size();
    capture.incidence = {.theta = 57.0 * std::numbers::pi / 180.0};
    const SkinReflectanceTable table(nm, capture.incidence, skin_fit_range({}));
    std::vector<std::string> names;
    capture.sensor = DenseMatrix(bands, bands);
    for (std::size_t b = 0; b < bands; ++b) {
      capture.sensor(b, b) = 1.0;
      names.push_back(std::to_string(static_cast<int>(nm[b])) + "nm");
    }
    capture.wavelengths = std::move(nm);
    capture.errors.assign(bands, 0.005);
    capture.reflectance = make_image(side, side, names);
    capture.mask = make_pixel_mask(side, side);
    capture.numbers.clear();
    const std::vector<SkinFitNumber> all = skin_fit_numbers({});
    for (const std::size_t n : numbers) capture.numbers.push_back(all[n]);
    std::ranges::fill(capture.population->missed_components.values, 0.0);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    const std::vector<SkinParameters> people = draw_skins(*capture.population, side * side, 2);
    for (std::size_t i = 0; i < people.size(); ++i) {
      SkinParameters skin = capture.skin.skin;
      for (const SkinFitNumber& number : capture.numbers)
        for (double SkinParameters::*const value : number.values) skin.*value = people[i].*value;
      skins.push_back(skin);
      const std::vector<double> reflected = table.reflectance(skin);
      for (std::size_t b = 0; b < bands; ++b)
        capture.reflectance.pixels[i * bands + b] = static_cast<float>(
            reflected[b] * (1.0 + factors[b] * capture.errors[b] * normal(random)));
    }
  }

  [[nodiscard]] double coverage(const AcquiredSkin& skin, double deviations) const {
    double covered = 0.0, count = 0.0;
    for (const AcquiredNumber& number : skin.numbers)
      for (std::size_t i = 0; i < skins.size(); ++i) {
        const FitParameter& parameter = number.number.parameter;
        const double off = fit_coordinate(parameter, static_cast<double>(number.values.pixels[i])) -
                           fit_coordinate(parameter, skins[i].*number.number.values[0]);
        covered += std::abs(off) < deviations * static_cast<double>(number.deviations.pixels[i]);
        count += 1.0;
      }
    return covered / count;
  }
};

// Each band's noise is another multiple of what is stated.
TEST(PatchAcquisition, ErrorsGrowToWhatPixelsLeave) {
  const std::vector<double> factors = {3.0, 1.0, 6.0, 2.0, 3.0, 1.0};
  const UnderstatedPixels pixels({420.0, 480.0, 520.0, 545.0, 580.0, 680.0}, {0, 2, 3, 4}, factors);
  const AcquiredSkin skin = acquire_patch(
      pixels.capture, {.has_transport = false, .inversion = {.deviation_samples = 1}});
  ASSERT_EQ(skin.chi_squared.size(), factors.size());
  // Bands that the numbers follow nearly everywhere take some of what the others have.
  for (const std::size_t b : {0u, 2u, 4u})
    EXPECT_NEAR(std::sqrt(skin.chi_squared[b]) / factors[b], 1.0, 0.15) << b;
  for (const double chi_squared : skin.chi_squared) EXPECT_GT(chi_squared, 1.5);
  EXPECT_NEAR(pixels.coverage(skin, 1.0), 0.68, 0.06);
  EXPECT_NEAR(pixels.coverage(skin, 2.0), 0.95, 0.03);
  AcquisitionCheck check;
  const std::vector<std::string> notes = notes_of_misfit(pixels.capture, skin, check);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("(520nm, errors"), std::string::npos) << notes[0];
}

// Tiles of pixels on their own have the errors of the whole, though fewer pixels of their own.
TEST(PatchAcquisition, ErrorsGrowInTilesAsInTheWhole) {
  UnderstatedPixels pixels({420.0, 545.0, 580.0, 680.0}, {0, 3}, {3.0, 1.0, 2.0, 3.0});
  pixels.capture.reflectance.width = 72;
  pixels.capture.reflectance.height = 8;
  pixels.capture.mask = make_pixel_mask(72, 8);
  PatchAcquisitionOptions options{.has_transport = false, .inversion = {.deviation_samples = 1}};
  const AcquiredSkin whole = acquire_patch(pixels.capture, options);
  options.most_bytes = 1.0;
  ASSERT_EQ(count_tiles(pixels.capture, options), 2U);
  const AcquiredSkin tiled = acquire_patch(pixels.capture, options);
  EXPECT_GT(whole.error_growth[0], 1.5);
  EXPECT_EQ(tiled.error_growth, whole.error_growth);
  EXPECT_EQ(tiled.chi_squared, whole.chi_squared);
  for (std::size_t n = 0; n < whole.numbers.size(); ++n) {
    EXPECT_EQ(tiled.numbers[n].values.pixels, whole.numbers[n].values.pixels);
    EXPECT_EQ(tiled.numbers[n].deviations.pixels, whole.numbers[n].deviations.pixels);
  }
}

TEST(PatchAcquisition, ErrorsGrowToWhatColorsLeave) {
  UnderstatedPixels pixels({450.0, 550.0, 650.0}, {0, 3}, {4.0, 4.0, 4.0});
  const SkinReflectanceTable table(pixels.capture.wavelengths, pixels.capture.incidence,
                                   skin_fit_range({}));
  std::ranges::fill(pixels.capture.population->missed, 0.0);
  const std::vector<BandMisfit> misfit = misfit_of_pixels(pixels.capture, table);
  for (const double chi_squared : chi_squared_of(misfit)) EXPECT_NEAR(chi_squared, 15.0, 5.0);
  const AcquiredSkin skin =
      acquire_pixels(pixels.capture, lookup_of(pixels.capture, table, error_growth_of(misfit)));
  EXPECT_NEAR(pixels.coverage(skin, 1.0), 0.68, 0.07);
  EXPECT_NEAR(pixels.coverage(skin, 2.0), 0.95, 0.04);
}

TEST(PatchAcquisition, RefusesWhatCannotTell) {
  const auto message = [](const Capture& capture, bool has_transport) -> std::string {
    try {
      (void)acquire_patch(capture, {.has_transport = has_transport});
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  Capture unsized = made().capture;
  unsized.mm_per_pixel.reset();
  EXPECT_EQ(message(unsized, true),
            "capture: light that travels sideways needs \"mm_per_pixel\", which is missing");
  Capture alone = made().capture;
  alone.population.reset();
  alone.numbers = skin_fit_numbers({});
  EXPECT_EQ(message(alone, false),
            "capture: 3 bands cannot tell 8 numbers; give a \"population\", or fewer \"numbers\"");
}

TEST(AcquiredFiles, AreReadByWhatUsesThem) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "lamina_acquired";
  const AcquiredFiles files = save_acquired(acquired(), made().capture, folder, "1.0");
  const JsonDocument document = load_json(files.material);
  const JsonObject object =
      document.root().file_object("material", 1, {"name", "length_unit", "surface", "skin"});
  const JsonObject surface = object.required("surface").object({"roughness", "specular_roughness"});
  // Layers as the inversion saw them, under a surface that shows no images of lamps.
  EXPECT_EQ(surface.required("roughness").number({.low = 0.0, .high = 1.0}), 0.0);
  EXPECT_NEAR(surface.required("specular_roughness").number({.low = 0.0, .high = 1.0}), 0.32, 1e-9);
  const SkinMaps maps = decode_skin_maps(object.required("skin"));
  ASSERT_EQ(maps.maps.size(), 4U);  // both saturations are one map
  EXPECT_TRUE(maps.warnings.empty());
  EXPECT_EQ(maps.maps[0].name, "melanin");
  EXPECT_EQ(maps.maps[0].values.pixels, acquired().numbers[0].values.pixels);
  EXPECT_EQ(load_image(files.mask).pixels[2], 0.0f);
  EXPECT_TRUE(std::filesystem::exists(files.patch));
  std::filesystem::remove_all(folder);
}

// Who made a table of its own would make it for the incidence of the capture, not the other one.
TEST(SkinAcquisition, TakesOneTableEverywhere) {
  Capture own = made().capture;
  own.mask = make_pixel_mask(6, 4);
  Capture handed = own, other = own;
  handed.incidence = other.incidence = {.theta = 57.0 * std::numbers::pi / 180.0};
  handed.table = table_of(own);  // of diffuse light
  const PatchAcquisitionOptions brief{.inversion = {.deviation_samples = 0}};
  for (const AcquisitionPlan plan : {AcquisitionPlan{.has_table = true}, AcquisitionPlan{}}) {
    const SkinAcquisition expected = acquire_skin(own, plan, brief);
    const SkinAcquisition same = acquire_skin(handed, plan, brief);
    const SkinAcquisition unlike = acquire_skin(other, plan, brief);
    for (std::size_t n = 0; n < own.numbers.size(); ++n) {
      EXPECT_EQ(same.skin.numbers[n].values.pixels, expected.skin.numbers[n].values.pixels);
      EXPECT_EQ(same.skin.numbers[n].deviations.pixels, expected.skin.numbers[n].deviations.pixels);
      EXPECT_NE(unlike.skin.numbers[n].values.pixels, expected.skin.numbers[n].values.pixels);
    }
    EXPECT_EQ(same.check.residual, expected.check.residual);
    EXPECT_EQ(same.check.by_calibration.values, expected.check.by_calibration.values);
    EXPECT_NE(unlike.check.residual, expected.check.residual);
  }
}

}  // namespace
}  // namespace lamina
