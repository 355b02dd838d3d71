// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/color.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "base/spectrum/shared_table.h"

namespace lamina {
namespace {

std::array<double, 2> chromaticity(const Xyz& color) {
  const double sum = color[0] + color[1] + color[2];
  return {color[0] / sum, color[1] / sum};
}

TEST(Cie1931, WhitesHaveTheirPublishedChromaticities) {  // [CIE015] to the rounding of 5 nm sums
  const auto d65 = chromaticity(white_point(Illuminant::d65));
  EXPECT_NEAR(d65[0], 0.31272, 3e-5);
  EXPECT_NEAR(d65[1], 0.32903, 3e-5);
  const auto a = chromaticity(white_point(Illuminant::a));
  EXPECT_NEAR(a[0], 0.44757, 2e-5);
  EXPECT_NEAR(a[1], 0.40744, 2e-5);
  const auto e = chromaticity(white_point(Illuminant::equal_energy));
  EXPECT_NEAR(e[0], 1.0 / 3.0, 6e-5);
  EXPECT_NEAR(e[1], 1.0 / 3.0, 6e-5);
}

TEST(Cie1931, AgreesWithTheTablesOfOneNanometre) {
  const auto observer = shared_table("colorimetry/cie1931_2deg.csv");
  const auto illuminants = shared_table("colorimetry/illuminants_1nm.csv");
  if (observer.empty() || illuminants.empty()) GTEST_SKIP() << "no reference data";
  std::size_t rows = 0;
  for (const auto& row : observer)
    for (const ColorMatchingRow& own : color_matching_table())
      if (own.wavelength == row[0]) {
        ++rows;
        EXPECT_NEAR(own.x, row[1], 1e-16) << row[0];
        EXPECT_NEAR(own.y, row[2], 1e-16) << row[0];
        EXPECT_NEAR(own.z, row[3], 1e-16) << row[0];
      }
  EXPECT_EQ(rows, color_matching_table().size());
  for (const auto& row : illuminants) {
    if (row[0] < 360.0) continue;
    EXPECT_NEAR(illuminant_power(Illuminant::a, row[0]), row[1], 1e-5 * row[1]) << row[0];
    EXPECT_NEAR(illuminant_power(Illuminant::d65, row[0]), row[3], 1.1e-3) << row[0];  // six digits
  }
}

TEST(Cie1931, IsDarkOutsideItsTable) {
  for (const double wavelength : {0.0, 359.9, 830.1, 1e9, std::nan("")})
    EXPECT_EQ(illuminant_power(Illuminant::d65, wavelength), 0.0);
}

TEST(Srgb, MatrixIsThePrintedOne) {  // [IEC61966-2-1] Eqs. 9, 10: four digits
  const Matrix3 printed = {
      {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(linear_srgb_to_xyz()[i][j], printed[i][j], 0.6e-4);
  for (const double channel : xyz_to_linear_srgb() * srgb_white()) EXPECT_NEAR(channel, 1.0, 1e-14);
}

TEST(Srgb, TransferHasItsFixedPointsAndJoint) {
  EXPECT_EQ(srgb_encode(0.0), 0.0);
  EXPECT_NEAR(srgb_encode(1.0), 1.0, 1e-15);
  EXPECT_NEAR(srgb_decode(1.0), 1.0, 1e-15);
  EXPECT_NEAR(srgb_decode(0.5), 0.21404114048223255, 1e-15);  // ((0.5 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(srgb_encode(0.0031308), srgb_encode(std::nextafter(0.0031308, 1.0)), 3e-8);
  EXPECT_EQ(srgb_encode(-0.18), -srgb_encode(0.18));
}

RC_GTEST_PROP(Srgb, DecodingUndoesEncoding, ()) {
  const double linear = *rc::gen::inRange(-1000, 100'000) / 1000.0;
  RC_ASSERT(std::abs(srgb_decode(srgb_encode(linear)) - linear) <=
            1e-12 * (1.0 + std::abs(linear)));
}

TEST(Bradford, TurnsOneWhiteIntoTheOtherAndBack) {
  const Xyz a = white_point(Illuminant::a), d65 = srgb_white();
  const Matrix3 adaptation = bradford_adaptation(a, d65);
  const Xyz white = adaptation * a;
  const Matrix3 unit = bradford_adaptation(d65, a) * adaptation;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(white[i], d65[i], 1e-14);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(unit[i][j], i == j ? 1.0 : 0.0, 1e-13);
  }
  // [Lindbloom2003] prints A to D65 with seven digits, for whites of five.
  const Matrix3 printed = {{{0.8446965, -0.1179225, 0.3948108},
                            {-0.1366303, 1.1041226, 0.1291718},
                            {0.0798489, -0.1348999, 3.1924009}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(adaptation[i][j], printed[i][j], 2e-3);
}

TEST(Lab, OfSrgbPrimariesIsKnown) {  // from the exact matrix, D65; widely tabulated to two digits
  const Lab white = lab(LinearSrgb{1.0, 1.0, 1.0});
  EXPECT_NEAR(white.lightness, 100.0, 1e-12);
  EXPECT_NEAR(white.a, 0.0, 1e-12);
  EXPECT_NEAR(white.b, 0.0, 1e-12);
  const Lab red = lab(LinearSrgb{1.0, 0.0, 0.0});
  EXPECT_NEAR(red.lightness, 53.24, 0.01);
  EXPECT_NEAR(red.a, 80.09, 0.02);
  EXPECT_NEAR(red.b, 67.20, 0.02);
  EXPECT_NEAR(
      lab(LinearSrgb{0.18418651851244416, 0.18418651851244416, 0.18418651851244416}).lightness,
      50.0, 1e-9);  // Y = (66 / 116)^3
}

// [Sharma2005] Table 1: all 34 pairs, chosen to find every slip in the formula.
TEST(ColorDifference, EqualsThePublishedPairs) {
  struct Pair {
    Lab first, second;
    double difference;
  };
  const Pair pairs[] = {
      {{50.0000, 2.6772, -79.7751}, {50.0000, 0.0000, -82.7485}, 2.0425},
      {{50.0000, 3.1571, -77.2803}, {50.0000, 0.0000, -82.7485}, 2.8615},
      {{50.0000, 2.8361, -74.0200}, {50.0000, 0.0000, -82.7485}, 3.4412},
      {{50.0000, -1.3802, -84.2814}, {50.0000, 0.0000, -82.7485}, 1.0000},
      {{50.0000, -1.1848, -84.8006}, {50.0000, 0.0000, -82.7485}, 1.0000},
      {{50.0000, -0.9009, -85.5211}, {50.0000, 0.0000, -82.7485}, 1.0000},
      {{50.0000, 0.0000, 0.0000}, {50.0000, -1.0000, 2.0000}, 2.3669},
      {{50.0000, -1.0000, 2.0000}, {50.0000, 0.0000, 0.0000}, 2.3669},
      {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0009}, 7.1792},
      {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0010}, 7.1792},
      {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0011}, 7.2195},
      {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0012}, 7.2195},
      {{50.0000, -0.0010, 2.4900}, {50.0000, 0.0009, -2.4900}, 4.8045},
      {{50.0000, -0.0010, 2.4900}, {50.0000, 0.0010, -2.4900}, 4.8045},
      {{50.0000, -0.0010, 2.4900}, {50.0000, 0.0011, -2.4900}, 4.7461},
      {{50.0000, 2.5000, 0.0000}, {50.0000, 0.0000, -2.5000}, 4.3065},
      {{50.0000, 2.5000, 0.0000}, {73.0000, 25.0000, -18.0000}, 27.1492},
      {{50.0000, 2.5000, 0.0000}, {61.0000, -5.0000, 29.0000}, 22.8977},
      {{50.0000, 2.5000, 0.0000}, {56.0000, -27.0000, -3.0000}, 31.9030},
      {{50.0000, 2.5000, 0.0000}, {58.0000, 24.0000, 15.0000}, 19.4535},
      {{50.0000, 2.5000, 0.0000}, {50.0000, 3.1736, 0.5854}, 1.0000},
      {{50.0000, 2.5000, 0.0000}, {50.0000, 3.2972, 0.0000}, 1.0000},
      {{50.0000, 2.5000, 0.0000}, {50.0000, 1.8634, 0.5757}, 1.0000},
      {{50.0000, 2.5000, 0.0000}, {50.0000, 3.2592, 0.3350}, 1.0000},
      {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
      {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
      {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
      {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
      {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
      {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
      {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
      {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
      {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
      {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
  };
  for (const auto& [first, second, difference] : pairs) {
    EXPECT_NEAR(color_difference(first, second), difference, 5e-5) << first.lightness;  // 4 digits
    EXPECT_NEAR(color_difference(second, first), difference, 5e-5) << first.lightness;
  }
}

}  // namespace
}  // namespace lamina
