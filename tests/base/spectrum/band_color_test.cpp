// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/band_color.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/spectrum/shared_table.h"
#include "lamina/base/core/random.h"

namespace lamina {
namespace {

constexpr Illuminant illuminants[] = {Illuminant::d65, Illuminant::a, Illuminant::equal_energy};

BandSet every(double step) {
  std::vector<double> wavelengths;
  for (double wavelength = 400.0; wavelength <= 700.0; wavelength += step)
    wavelengths.push_back(wavelength);
  return BandSet(wavelengths);
}

std::vector<BandSet> band_sets() {
  return {default_spectral_bands(), every(10.0), every(2.0), BandSet({450.0, 550.0, 620.0}),
          BandSet({400.0, 420.0, 480.0, 580.0, 690.0})};
}

using Reflectance = std::function<double(double wavelength)>;

/// The colour by sums over 5 nm, as [CIE015] defines it.
LinearSrgb true_color(const Reflectance& reflectance, Illuminant illuminant) {
  Xyz sum{};
  double white = 0.0;
  for (const ColorMatchingRow& row : color_matching_table()) {
    const double power = illuminant_power(illuminant, row.wavelength);
    const double light = power * reflectance(row.wavelength);
    sum = {sum[0] + light * row.x, sum[1] + light * row.y, sum[2] + light * row.z};
    white += power * row.y;
  }
  for (double& value : sum) value /= white;
  return xyz_to_linear_srgb() * (bradford_adaptation(white_point(illuminant), srgb_white()) * sum);
}

LinearSrgb band_color(const Reflectance& reflectance, const BandSet& bands, Illuminant illuminant) {
  std::vector<double> spectrum;
  for (const double wavelength : bands.wavelengths()) spectrum.push_back(reflectance(wavelength));
  return linear_srgb(make_band_weights(bands, illuminant), spectrum);
}

struct Errors {
  double median_difference, largest_difference;  ///< CIEDE2000
  double largest_linear;
};

Errors errors(const std::vector<Reflectance>& samples, const BandSet& bands,
              Illuminant illuminant) {
  std::vector<double> differences;
  double linear = 0.0;
  for (const Reflectance& sample : samples) {
    const LinearSrgb is = band_color(sample, bands, illuminant);
    const LinearSrgb should = true_color(sample, illuminant);
    differences.push_back(color_difference(lab(is), lab(should)));
    for (std::size_t c = 0; c < 3; ++c) linear = std::max(linear, std::abs(is[c] - should[c]));
  }
  std::ranges::sort(differences);
  return {differences[differences.size() / 2], differences.back(), linear};
}

TEST(BandWeights, WhiteIsExactlyWhiteUnderEveryIlluminant) {
  for (const BandSet& bands : band_sets())
    for (const Illuminant illuminant : illuminants) {
      const std::vector<double> white(bands.size(), 1.0);
      std::array<float, 3> single{};
      for (const auto& weight : make_band_weights(bands, illuminant))
        for (std::size_t c = 0; c < 3; ++c) single[c] += static_cast<float>(weight[c]);
      EXPECT_EQ(single, (std::array<float, 3>{1.0f, 1.0f, 1.0f}));
      EXPECT_EQ(linear_srgb(make_band_weights(bands, illuminant), white),
                (LinearSrgb{1.0, 1.0, 1.0}));
    }
}

TEST(BandWeights, RgbBandsAreTheColor) {
  EXPECT_EQ(linear_srgb(make_band_weights(BandSet::rgb()), std::vector{0.1, 0.2, 0.3}),
            (LinearSrgb{0.1, 0.2, 0.3}));
}

TEST(BandWeights, OneBandIsGrey) {
  EXPECT_EQ(linear_srgb(make_band_weights(BandSet({550.0})), std::vector{0.25}),
            (LinearSrgb{0.25, 0.25, 0.25}));
}

// Skin-like: a pigment that rises with wavelength and the two bands of oxygenated blood.
TEST(BandWeights, EightBandsShowASkinLikeSpectrum) {
  const auto skin = [](double wavelength) {
    const auto bump = [&](double center, double width) {
      const double x = (wavelength - center) / width;
      return std::exp(-0.5 * x * x);
    };
    return 0.60 / (1.0 + std::exp(-(wavelength - 480.0) / 90.0)) -
           0.03 * (bump(542.0, 12.0) + bump(577.0, 9.0)) - 0.04 * bump(418.0, 16.0);
  };
  const std::vector<Reflectance> samples = {skin};
  for (const Illuminant illuminant : illuminants) {
    EXPECT_LT(errors(samples, default_spectral_bands(), illuminant).largest_linear, 0.008);
    EXPECT_LT(errors(samples, every(5.0), illuminant).largest_linear, 3e-4);
  }
}

TEST(BandWeights, EightBandsShowMeasuredSkin) {
  const auto table = shared_table("skin/nist_skin_reflectance_mean_vis.csv");
  if (table.empty()) GTEST_SKIP() << "no reference data";
  std::vector<Reflectance> samples;
  for (std::size_t subject = 1; subject < table[0].size(); ++subject)
    samples.emplace_back([&table, subject](double wavelength) {
      return interpolate_column(table, wavelength, subject);
    });
  for (const Illuminant illuminant : illuminants) {
    const Errors found = errors(samples, default_spectral_bands(), illuminant);
    EXPECT_LT(found.median_difference, 0.35);
    EXPECT_LT(found.largest_difference, 0.85);
    EXPECT_LT(found.largest_linear, 0.008);
    EXPECT_LT(errors(samples, every(10.0), illuminant).largest_difference, 0.1);
  }
}

TEST(BandWeights, EightBandsShowSmoothSpectra) {
  std::vector<Reflectance> samples;
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random random = make_random(3, i);
    std::vector<std::array<double, 2>> waves;  // amplitude and phase of five harmonics
    for (int order = 1; order <= 5; ++order)
      waves.push_back({4.0 * (random.uniform() - 0.5) / order, 6.28 * random.uniform()});
    samples.emplace_back([waves](double wavelength) {
      double sum = 0.0;
      for (std::size_t k = 0; k < waves.size(); ++k)
        sum += waves[k][0] * std::cos(std::numbers::pi * static_cast<double>(k + 1) *
                                          (wavelength - 360.0) / 470.0 +
                                      waves[k][1]);
      return 1.0 / (1.0 + std::exp(-sum));
    });
  }
  const Errors daylight = errors(samples, default_spectral_bands(), Illuminant::d65);
  EXPECT_LT(daylight.median_difference, 0.1);
  EXPECT_LT(daylight.largest_linear, 0.006);
  EXPECT_LT(errors(samples, default_spectral_bands(), Illuminant::a).largest_linear, 0.012);
  EXPECT_LT(errors(samples, every(2.0), Illuminant::a).largest_linear, 1e-3);
}

TEST(BandBasis, TurnsEveryColorIntoASpectrumAndBack) {
  for (const BandSet& bands : band_sets())
    for (const Illuminant illuminant : illuminants) {
      const BandWeights weights = make_band_weights(bands, illuminant);
      const BandBasis basis = make_band_basis(bands, illuminant);
      for (const LinearSrgb& color : {LinearSrgb{1, 0, 0}, LinearSrgb{0, 1, 0}, LinearSrgb{0, 0, 1},
                                      LinearSrgb{0.2, 5, 0.7}}) {
        const LinearSrgb back = linear_srgb(weights, band_spectrum(basis, color));
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(back[c], color[c], 1e-9) << bands.size();
      }
      for (const double value : band_spectrum(basis, {1.0, 1.0, 1.0}))
        EXPECT_NEAR(value, 1.0, 1e-12);
    }
}

TEST(BandBasis, IsHardlyNegative) {
  for (const Illuminant illuminant : illuminants) {
    double lowest = 1.0, highest = 0.0;
    for (const auto& primaries : make_band_basis(default_spectral_bands(), illuminant))
      for (const double value : primaries) {
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
      }
    EXPECT_GT(lowest, -0.005);
    EXPECT_LT(highest, 1.006);
  }
}

TEST(BandWeights, TellColorsFromThreeVisibleBandsOn) {
  for (const BandSet& bands : {BandSet::rgb(), default_spectral_bands(), BandSet({450, 550, 620})})
    EXPECT_TRUE(tells_colors(make_band_weights(bands)));
}

TEST(BandBasis, WithoutColorVisionIsTheLuminance) {
  for (const BandSet& bands :
       {BandSet({550.0}), BandSet({500.0, 600.0}), BandSet({1000.0, 1500.0, 2000.0})}) {
    EXPECT_FALSE(tells_colors(make_band_weights(bands)));
    for (const double value : band_spectrum(make_band_basis(bands), {0.0, 1.0, 0.0}))
      EXPECT_NEAR(value, 0.7152, 1e-4);
    for (const double value : band_spectrum(make_band_basis(bands), {1.0, 1.0, 1.0}))
      EXPECT_NEAR(value, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace lamina
