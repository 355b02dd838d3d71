// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/spectrum/rgb_encoding.h"

namespace lamina {

/// Meaning of the numbers of an image. Alpha is always linear.
///
/// Colors become linear Rec.709. What a file says of its own (an ICC profile, chunks of PNG, Exif,
/// chromaticities of EXR) counts for `srgb`; and for `linear_colors` where the file says that its
/// numbers are light, of whatever primaries. An encoding by name (base/spectrum/rgb_encoding.h)
/// counts whatever the file says. Numbers that are no colors are never converted.
enum class ColorEncoding {
  srgb,           ///< colors as the file says; of integers where it says nothing, sRGB
  linear,         ///< quantities: fractions of pigment, roughness, normals
  linear_colors,  ///< linear light: as `linear`, but other primaries become Rec.709
  srgb_numbers,   ///< quantities, whose integers went through sRGB's curve
  srgb_texture,
  lin_rec709,
  g22_rec709,
  g18_rec709,
  rec709_display,
  acescg,
  g22_ap1,
  adobergb,
  lin_adobergb,
  srgb_displayp3,
  lin_displayp3,
};

template <>
inline constexpr auto enum_names<ColorEncoding> =
    std::to_array<EnumName<ColorEncoding>>({{"srgb", ColorEncoding::srgb},
                                            {"linear", ColorEncoding::linear},
                                            {"srgb_texture", ColorEncoding::srgb_texture},
                                            {"lin_rec709", ColorEncoding::lin_rec709},
                                            {"g22_rec709", ColorEncoding::g22_rec709},
                                            {"g18_rec709", ColorEncoding::g18_rec709},
                                            {"rec709_display", ColorEncoding::rec709_display},
                                            {"acescg", ColorEncoding::acescg},
                                            {"g22_ap1", ColorEncoding::g22_ap1},
                                            {"adobergb", ColorEncoding::adobergb},
                                            {"lin_adobergb", ColorEncoding::lin_adobergb},
                                            {"srgb_displayp3", ColorEncoding::srgb_displayp3},
                                            {"lin_displayp3", ColorEncoding::lin_displayp3}});

/// The encoding of an image of colors of which a user says one of the names.
[[nodiscard]] constexpr ColorEncoding of_colors(ColorEncoding said) {
  return said == ColorEncoding::linear ? ColorEncoding::linear_colors : said;
}

/// RGB encoding that a name states, whatever a file says; absent for the others.
[[nodiscard]] std::optional<RgbEncoding> stated_encoding(ColorEncoding encoding);

}  // namespace lamina
