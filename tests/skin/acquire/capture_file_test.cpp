// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/files/capture_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>

#include "base/io/bad_files.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/spectrum/band_color.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {
namespace {

const std::filesystem::path captures = LAMINA_SOURCE_DIR "/tests/inputs/capture";

Capture developed(const std::filesystem::path& file, std::span<const std::string> settings = {}) {
  return develop_capture(load_capture(file, {}, settings));
}

TEST(CaptureFile, SaysWhatIsWrong) {
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      (void)developed(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_GT(expect_refusals(captures / "bad", refusal), 18U);
}

// What photographs show is looked for when they are developed.
TEST(CaptureFile, IsReadWithoutDeveloping) {
  for (const char* file : {"bad/window_not_found.json", "bad/chart_not_found.json",
                           "bad/too_small_to_register.json", "bad/card_uneven.json"}) {
    const CaptureDescription read = load_capture(captures / file);
    EXPECT_GT(read.capture.wavelengths.size(), 0U) << file;
    EXPECT_THROW((void)develop_capture(read), InvalidInput) << file;
  }
}

TEST(CaptureFile, ReadsATexture) {
  const Capture capture = developed(captures / "good/texture.json");
  EXPECT_EQ(capture.reflectance.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(capture.errors, (std::vector{0.01, 0.01, 0.02}));
  EXPECT_FLOAT_EQ(capture.reflectance.at(0, 0)[1], static_cast<float>(srgb_decode(160.0 / 255.0)));
  EXPECT_FALSE(capture.mask.is_used(3, 0));  // by the mask
  EXPECT_TRUE(capture.mask.is_used(4, 0));
  EXPECT_EQ(count_pixels(capture.mask).faults[3], 9U);  // saturated
  EXPECT_EQ(capture.numbers.size(), 3U);
  EXPECT_EQ(capture.skin.skin.epidermis_thickness, 0.2);
  EXPECT_EQ(*capture.mm_per_pixel, 0.2);
  // A spectrum has the color that it has everywhere else.
  std::vector<double> spectrum;
  for (const double nm : capture.wavelengths) spectrum.push_back(0.3 + 0.001 * (nm - 400.0));
  const LinearSrgb expected =
      linear_srgb(make_band_weights(BandSet(capture.wavelengths)), spectrum);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::span row = capture.sensor.row(c);
    EXPECT_NEAR(std::inner_product(row.begin(), row.end(), spectrum.begin(), 0.0), expected[c],
                1e-12);
  }
}

TEST(CaptureFile, JoinsBands) {
  const Capture capture = developed(captures / "good/bands.json");
  EXPECT_EQ(capture.reflectance.channels, (std::vector<std::string>{"450nm", "550nm", "650nm"}));
  EXPECT_TRUE(capture.has_specular);
  EXPECT_EQ(capture.errors, (std::vector{0.005, 0.005, 0.02}));
  const Capture same =
      developed(captures / "good/bands.json", std::vector<std::string>{"images[0].white=0.45"});
  EXPECT_FLOAT_EQ(same.reflectance.at(5, 5)[0], 2.0f * capture.reflectance.at(5, 5)[0]);
  EXPECT_FLOAT_EQ(same.reflectance.at(5, 5)[1], capture.reflectance.at(5, 5)[1]);
  // The wide band is symmetric about its middle, the others are one wavelength.
  double sum = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t w = 0; w < capture.wavelengths.size(); ++w) {
    sum += capture.sensor(0, w);
    mean += capture.sensor(0, w) * capture.wavelengths[w];
    squares += capture.sensor(0, w) * std::pow(capture.wavelengths[w] - 450.0, 2);
    EXPECT_EQ(capture.sensor(1, w), capture.wavelengths[w] == 550.0 ? 1.0 : 0.0);
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(mean, 450.0, 1e-9);
  EXPECT_NEAR(std::sqrt(squares), 20.0 / 2.3548, 0.1);  // a Gaussian's full width at half height
}

// The files hold skin of .45, .29, .22 with a texture of 4 %, in uneven light, 8 above black, and
// a highlight of .3 that the crossed image does not have.
TEST(CaptureFile, DevelopsAPairOfPhotographs) {
  const Capture capture = developed(captures / "good/photograph.json");
  double sum = 0.0;
  int count = 0, marked = 0;
  for (int y = 9; y < 39; ++y)
    for (int x = 11; x < 53; ++x)
      if (capture.mask.is_used(x, y)) {
        sum += static_cast<double>(capture.reflectance.at(x, y)[0]);
        ++count;
      } else {
        ++marked;
      }
  EXPECT_NEAR(sum / count, 0.46, 0.01);  // .005 of stray light through the window
  EXPECT_LT(marked, 300);
  EXPECT_FALSE(capture.mask.is_used(9, 8));  // at the tape
  EXPECT_EQ(capture.lights.size(), 1U);
  EXPECT_EQ(capture.notes.size(), 1U);
  for (const double error : capture.errors) EXPECT_GT(error, 0.004);
  // Deviations are kept where the noise is more than what is stated.
  EXPECT_TRUE(capture.deviation.pixels.empty());
  const Capture stated = developed(captures / "good/photograph.json",
                                   std::vector<std::string>{"images[0].error=1e-4"});
  EXPECT_EQ(stated.deviation.pixels.size(), stated.reflectance.pixels.size());
}

// A matte white behind crossed or parallel sheets has half of its light, which the black level does
// not lose: the same skin must come out.
TEST(CaptureFile, CountsTheSheetsThatWhiteWasSeenThrough) {
  const auto folder = std::filesystem::temp_directory_path();
  const Image dark = load_image(captures / "good/dark.png", ColorEncoding::linear);
  Image white = load_image(captures / "good/white.png", ColorEncoding::linear);
  for (std::size_t i = 0; i < white.pixels.size(); ++i)
    white.pixels[i] = dark.pixels[i] + 0.5f * (white.pixels[i] - dark.pixels[i]);
  const auto file = folder / "lamina_white_behind_sheets.exr";
  save_exr(white, file);
  const auto red = [](std::vector<std::string> settings) {
    const Capture capture = developed(captures / "good/photograph.json", settings);
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < capture.mask.faults.size(); ++i)
      if (capture.mask.faults[i] == 0) {
        sum += static_cast<double>(capture.reflectance.pixels[3 * i]);
        ++count;
      }
    return sum / count;
  };
  const double known = red({});
  EXPECT_NEAR(known, 0.46, 0.01);
  const std::string image = "images[0].white.image=\"" + file.string() + "\"";
  for (const char* sheets : {"crossed", "parallel"})
    EXPECT_NEAR(red({image, std::string("images[0].white.polarizers=\"") + sheets + "\""}) / known,
                1.0, 0.003);
  // A number says the same as an image that holds it everywhere.
  const double by_number = red({R"(images[0].white={"level": 0.8, "polarizers": "none"})"});
  EXPECT_NEAR(red({R"(images[0].white={"level": 0.4, "polarizers": "crossed"})"}), by_number, 1e-6);
  std::filesystem::remove(file);
}

// EXR files hold channels by their names: B before R.
TEST(CaptureFile, TakesColorsAsSuchInAnyOrder) {
  const auto file = std::filesystem::temp_directory_path() / "lamina_capture_colors.exr";
  Image skin = make_image(16, 12, {"R", "G", "B"});
  for (std::size_t i = 0; i < skin.pixels.size(); ++i)
    skin.pixels[i] = std::array{0.5f, 0.3f, 0.2f}[i % 3];
  save_exr(skin, file);
  const Capture capture = developed(captures / "good/texture.json",
                                    std::vector{"images[0].image=\"" + file.string() + "\""});
  EXPECT_EQ(capture.reflectance.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_NEAR(capture.reflectance.at(5, 5)[0], 0.5f, 1e-3f);
  EXPECT_NEAR(capture.reflectance.at(5, 5)[2], 0.2f, 1e-3f);
  std::filesystem::remove(file);
}

TEST(CaptureFile, TakesPatternsOfLight) {
  const Capture capture = developed(captures / "good/strips.json");
  EXPECT_EQ(capture.reflectance.channels,
            (std::vector<std::string>{"550nm", "550nm by strips.png", "650nm by strips.png"}));
  ASSERT_EQ(capture.lights.size(), 2U);
  EXPECT_EQ(capture.band_lights, (std::vector<std::size_t>{0, 1, 1}));
  EXPECT_EQ(capture.lights[0].at(5, 5)[0], 1.0f);
  EXPECT_EQ(capture.lights[1].at(5, 5)[0], 1.0f);
  EXPECT_EQ(capture.lights[1].at(7, 5)[0], 0.0f);
}

TEST(CaptureFile, ReadsALeafInTheBandsOfItsFile) {
  const Capture capture = developed(captures / "good/leaf.json");
  ASSERT_TRUE(capture.leaf);
  EXPECT_EQ(*capture.leaf->ground, 0.1);
  EXPECT_FALSE(capture.leaf->has_background);
  ASSERT_EQ(capture.wavelengths.size(), 10U);
  EXPECT_EQ(capture.wavelengths[5], 680.0);
  EXPECT_EQ(capture.sensor(5, 5), 1.0);
  EXPECT_NEAR(static_cast<double>(capture.reflectance.at(0, 0)[8]), 0.45, 1e-4);
}

TEST(CaptureFile, KnowsHowMuchLightFallsOnTiltedSkin) {
  const auto first = [](std::vector<std::string> settings) {
    return static_cast<double>(
        developed(captures / "good/bands.json", settings).reflectance.at(8, 6)[0]);
  };
  const double flat = first({"incidence=30"});
  EXPECT_NEAR(first({"incidence=30", "images[0].distance=[400, 200]"}) / flat, 4.0, 1e-5);
  // Turned by 30 degrees the skin meets the light that came from 30 degrees head on.
  EXPECT_NEAR(first({"incidence=30", "images[0].tilt=30"}) / flat, std::sqrt(0.75), 1e-5);
}

TEST(CaptureFile, TakesWhiteFromACard) {
  const Capture capture = developed(captures / "good/card.json");
  EXPECT_NEAR(static_cast<double>(capture.reflectance.at(45, 15)[0]), 0.45, 0.03);
  EXPECT_NEAR(static_cast<double>(capture.reflectance.at(45, 15)[2]), 0.22, 0.02);
  ASSERT_EQ(capture.notes.size(), 1U);
  EXPECT_TRUE(capture.notes[0].starts_with("the window was found at 8.0, 6.0; 56.0, 6.0;"))
      << capture.notes[0];
}

TEST(CaptureFile, WeighsACameraByItsCurvesAndTheLight) {
  const Capture capture = developed(captures / "good/camera.json");
  EXPECT_FALSE(capture.incidence.is_diffuse);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::span row = capture.sensor.row(c);
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1.0, 1e-12);
  }
  // Of red: 550 and 600 nm, by the curve .1 to 1, under illuminant A, which rises.
  const auto at = [&](double nm) {
    for (std::size_t w = 0; w < capture.wavelengths.size(); ++w)
      if (capture.wavelengths[w] == nm) return capture.sensor(0, w);
    return -1.0;
  };
  const double a = illuminant_power(Illuminant::a, 600.0) / illuminant_power(Illuminant::a, 550.0);
  EXPECT_NEAR(at(600.0) / at(550.0), 10.0 * a, 1e-9);
}

}  // namespace
}  // namespace lamina
