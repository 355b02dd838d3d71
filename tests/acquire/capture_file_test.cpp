// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>

#include "io/bad_files.h"
#include "lamina/acquire/capture.h"
#include "lamina/core/error.h"
#include "lamina/spectrum/band_color.h"
#include "lamina/spectrum/srgb.h"

namespace lamina {
namespace {

const std::filesystem::path captures = LAMINA_SOURCE_DIR "/tests/inputs/capture";

TEST(CaptureFile, SaysWhatIsWrong) {
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      (void)load_capture(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_GT(expect_refusals(captures / "bad", refusal), 18U);
}

TEST(CaptureFile, ReadsATexture) {
  const Capture capture = load_capture(captures / "good/texture.json");
  EXPECT_EQ(capture.reflectance.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(capture.errors, (std::vector{0.01, 0.01, 0.02}));
  EXPECT_FLOAT_EQ(capture.reflectance.at(0, 0)[1], static_cast<float>(srgb_decode(160.0 / 255.0)));
  EXPECT_EQ(capture.saturation, std::vector(3, 1.0));
  EXPECT_TRUE(capture.is_masked[3]);
  EXPECT_FALSE(capture.is_masked[4]);
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
  const Capture capture = load_capture(captures / "good/bands.json");
  EXPECT_EQ(capture.reflectance.channels, (std::vector<std::string>{"450nm", "550nm", "650nm"}));
  EXPECT_TRUE(capture.has_specular);
  EXPECT_EQ(capture.errors, (std::vector{0.005, 0.005, 0.02}));
  const Capture same = load_capture(captures / "good/bands.json", {},
                                    std::vector<std::string>{"images[0].white=0.45"});
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

TEST(CaptureFile, WeighsACameraByItsCurvesAndTheLight) {
  const Capture capture = load_capture(captures / "good/camera.json");
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
