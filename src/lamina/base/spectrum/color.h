// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lamina/base/core/vec.h"
#include "lamina/base/spectrum/cie_1931.h"
#include "lamina/base/spectrum/srgb.h"

namespace lamina {

using Xyz = std::array<double, 3>;         ///< CIE 1931 tristimulus values; Y = 1 is white
using LinearSrgb = std::array<double, 3>;  ///< linear light of sRGB's primaries; (1, 1, 1) is white
using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< [row][column]

/// The white of sRGB, of chromaticity (0.3127, 0.3290), with Y = 1. Source: [IEC61966-2-1] §4.1.
[[nodiscard]] Xyz srgb_white();

/// The white of an illuminant for the 2 degree observer, by sums over 5 nm, with Y = 1.
[[nodiscard]] Xyz white_point(Illuminant illuminant);

/// Chromaticities (x, y) of the primaries and the white of linear RGB.
struct RgbPrimaries {
  using Xy = std::array<double, 2>;
  Xy red, green, blue, white;

  bool operator==(const RgbPrimaries&) const = default;
};

/// Primaries of Rec.709 and sRGB. Source: [IEC61966-2-1] §4.1.
[[nodiscard]] RgbPrimaries rec709_primaries();

/// Tristimulus values of colors, Y = 1 of white, under the white of the space.
/// @throws InvalidInput if the primaries lie on a line, or y of white is not above 0
[[nodiscard]] Matrix3 rgb_to_xyz(const RgbPrimaries& primaries);

/// Not rounded to four digits as printed in [IEC61966-2-1], but from the chromaticities of its
/// primaries and white, so that white is (1, 1, 1).
[[nodiscard]] Matrix3 xyz_to_linear_srgb();
[[nodiscard]] Matrix3 linear_srgb_to_xyz();

/// The matrix that turns colours seen under one white into those that look alike under another.
/// Source: [Lam1985], the Bradford transform as [Lindbloom2003] gives it.
[[nodiscard]] Matrix3 bradford_adaptation(const Xyz& from_white, const Xyz& to_white);

[[nodiscard]] std::array<double, 3> operator*(const Matrix3& matrix,
                                              const std::array<double, 3>& vector);
[[nodiscard]] Matrix3 operator*(const Matrix3& a, const Matrix3& b);
[[nodiscard]] Matrix3 inverse(const Matrix3& matrix);

/// Luminance of a linear Rec.709 colour.
[[nodiscard]] inline float luminance(const Vec3f& c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/// CIELAB, for which a distance of 1 is about what an eye can tell. Source: [CIE015] §8.2.1.
struct Lab {
  double lightness, a, b;  ///< white is (100, 0, 0); a is red against green, b yellow against blue
};
[[nodiscard]] Lab lab(const Xyz& color, const Xyz& white);
[[nodiscard]] Lab lab(const LinearSrgb& color);

/// CIEDE2000, the difference of two colours as an average eye judges it. Source: [Sharma2005].
[[nodiscard]] double color_difference(const Lab& first, const Lab& second);

}  // namespace lamina
