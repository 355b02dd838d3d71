// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/spectrum/rgb_space.h"

#include <gtest/gtest.h>

#include "lamina/base/core/error.h"

namespace lamina {
namespace {

void expect_near(const Matrix3& found, const Matrix3& expected, double error) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(found[i][j], expected[i][j], error) << i << j;
}

// As printed in the standards of ACES: TRA1 of S-2014-004, and S-2008-001.
TEST(RgbSpace, MatricesOfAcesAreThosePrinted) {
  expect_near(rgb_to_xyz(primaries_of(RgbSpace::acescg)),
              {{{0.6624541811, 0.1340042065, 0.1561876870},
                {0.2722287168, 0.6740817658, 0.0536895174},
                {-0.0055746495, 0.0040607335, 1.0103391003}}},
              1e-9);
  expect_near(rgb_to_xyz(aces2065_primaries()),
              {{{0.9525523959, 0.0, 0.0000936786},
                {0.3439664498, 0.7281660966, -0.0721325464},
                {0.0, 0.0, 1.0088251844}}},
              1e-9);
}

// The matrix that renderers carry for textures in sRGB under ACES, to the digits they print.
TEST(RgbSpace, Rec709BecomesAcescgAsElsewhere) {
  expect_near(rgb_conversion(rec709_primaries(), primaries_of(RgbSpace::acescg)),
              {{{0.613097, 0.339523, 0.047379},
                {0.070194, 0.916354, 0.013452},
                {0.020616, 0.109570, 0.869815}}},
              2e-5);
}

TEST(RgbSpace, WhiteStaysAndThereAndBackIsNothing) {
  const RgbPrimaries rec709 = rec709_primaries();
  for (const RgbPrimaries& other : {primaries_of(RgbSpace::acescg), aces2065_primaries()}) {
    const Matrix3 there = rgb_conversion(rec709, other);
    for (const double value : there* std::array<double, 3>{1, 1, 1}) EXPECT_NEAR(value, 1, 1e-12);
    expect_near(rgb_conversion(other, rec709) * there, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 1e-12);
  }
}

TEST(RgbSpace, RefusesPrimariesOnALineAndWhiteWithoutLight) {
  RgbPrimaries on_line = rec709_primaries();
  on_line.blue = on_line.red;
  EXPECT_THROW((void)rgb_to_xyz(on_line), InvalidInput);
  RgbPrimaries dark = rec709_primaries();
  dark.white[1] = 0.0;
  EXPECT_THROW((void)rgb_conversion(dark, rec709_primaries()), InvalidInput);
}

}  // namespace
}  // namespace lamina
