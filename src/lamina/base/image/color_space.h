// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lamina/base/image/image.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/base/spectrum/rgb_encoding.h"

namespace lamina {

/// Treatment of negative numbers that only the conversion makes: of colors beyond the triangle
/// of the new primaries.
enum class Negative { kept, none };

/// Turns the colors of an image into those of other primaries (base/spectrum/rgb_space.h): the
/// channels R, G and B, and those of layers, "light.sun.R" and so on, wherever all three are there,
/// but for mattes (base/image/cryptomatte.h).
[[nodiscard]] Image converted_colors(Image image, const Matrix3& conversion,
                                     Negative negative = Negative::kept);

/// Decodes the channels R, G and B, and those of layers, as converted_colors finds them, and Y.
[[nodiscard]] Image decoded_colors(Image image, const RgbCurve& curve);

/// Whether an image has colors that converted_colors turns.
[[nodiscard]] bool has_colors(const Image& image);

}  // namespace lamina
