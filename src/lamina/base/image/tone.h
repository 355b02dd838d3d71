// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/core/enum_names.h"
#include "lamina/base/image/image.h"
#include "lamina/base/spectrum/color.h"

namespace lamina {

/// How scene light, which has no upper end, becomes the light of a display, in [0, 1].
enum class View {
  standard,  ///< as it is, cut off at 0 and 1: for measurements and comparisons
  filmic,    ///< mid grey stays, highlights roll off to white
  agx,       ///< softer, with 16.5 stops: bright colors lose saturation as film does
};

template <>
inline constexpr auto enum_names<View> = std::to_array<EnumName<View>>(
    {{"standard", View::standard}, {"filmic", View::filmic}, {"agx", View::agx}});

/// The filmic curve of one channel: contrast as of the scene at mid grey, a soft toe and shoulder.
///
/// f(x) = y(x) / y(w) for y(x) = x^n / (x^n + s), with n = 1.2, white at w = 16 (6.5 stops above
/// mid grey) and s such that f(0.18) = 0.18. Rises from f(0) = 0 to f(w) = 1 and stays there; at
/// mid grey a stop more light is 0.98 stops more on the display. NaN and negative light are 0.
///
/// Source: y is the response of photoreceptors, [NakaRushton1966] Eq. 1.
[[nodiscard]] double filmic_curve(double light);

/// The filmic view of a colour. The brightest and the darkest channel take the curve; the middle
/// one keeps its place between them, so the hue (of HSV) stays while highlights lose saturation,
/// and greys stay grey. Negative channels are 0.
[[nodiscard]] LinearSrgb filmic(const LinearSrgb& light);

/// The curve of AgX: a code value in [0, 1] of light on a logarithmic scale, 0 at 10 stops below
/// and 1 at 6.5 stops above mid grey, which is at 10 / 16.5 and becomes .5.
///
/// A hyperbola on either side of mid grey, of slope 2 there: powers 3 of the toe and 3.25 of the
/// shoulder.
/// Source: [Sobotka2019]
[[nodiscard]] double agx_curve(double stops);

/// The AgX view of a color, linear: the primaries are drawn in towards white, so that no channel is
/// alone, each takes the curve, the primaries are put back, and what a display of gamma 2.2 makes
/// of the code values is in [0, 1]. Negative light is 0.
///
/// Source: [Sobotka2019]; rows of its matrix are scaled to a sum of 1 (they are off by 1.4e-4), so
/// that greys stay grey.
[[nodiscard]] LinearSrgb agx(const LinearSrgb& light);

/// An image for display: the channels R, G, B (or Y) times 2^exposure, seen through the view; still
/// linear, in [0, 1], ready for save_png. A stays as it is, other channels are left out.
/// @param exposure  [stops].
/// @throws InvalidInput if there are no such channels.
[[nodiscard]] Image view_image(const Image& image, View view, double exposure = 0.0);

}  // namespace lamina
