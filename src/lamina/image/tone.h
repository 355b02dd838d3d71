// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/core/enum_names.h"
#include "lamina/image/image.h"
#include "lamina/spectrum/color.h"

namespace lamina {

/// How scene light, which has no upper end, becomes the light of a display, in [0, 1].
enum class View {
  standard,  ///< as it is, cut off at 0 and 1: for measurements and comparisons
  filmic,    ///< mid grey stays, highlights roll off to white
};

template <>
inline constexpr auto enum_names<View> =
    std::to_array<EnumName<View>>({{"standard", View::standard}, {"filmic", View::filmic}});

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

/// An image for display: the channels R, G, B (or Y) times 2^exposure, seen through the view; still
/// linear, in [0, 1], ready for save_png. A stays as it is, other channels are left out.
/// @param exposure  [stops].
/// @throws InvalidInput if there are no such channels.
[[nodiscard]] Image view_image(const Image& image, View view, double exposure = 0.0);

}  // namespace lamina
