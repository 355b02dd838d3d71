// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "lamina/base/spectrum/color.h"

namespace lamina {

/// How a number of a file becomes light; negative numbers are mirrored.
struct RgbCurve {
  enum class Kind {
    power,   ///< number^exponent; exponent 1 is light itself
    srgb,    ///< Source: [IEC61966-2-1] Eqs. 7, 8
    rec709,  ///< inverse of the camera's. Source: [BT709] §1.2, as [H273] Table 3 has it
  };
  Kind kind = Kind::power;
  double exponent = 1.0;

  bool operator==(const RgbCurve&) const = default;
};

[[nodiscard]] double linear_light(const RgbCurve& curve, double number);
[[nodiscard]] constexpr bool is_linear(const RgbCurve& curve) {
  return curve == RgbCurve{.kind = RgbCurve::Kind::power, .exponent = 1.0};
}

/// Encoding of RGB numbers: primaries and curve.
struct RgbEncoding {
  RgbPrimaries primaries = rec709_primaries();
  RgbCurve curve{.kind = RgbCurve::Kind::srgb};

  bool operator==(const RgbEncoding&) const = default;
};

/// Linear Rec.709 of a color in this encoding; whites are adapted by Bradford's transform.
/// @throws InvalidInput as rgb_to_xyz
[[nodiscard]] std::array<double, 3> linear_rec709(const RgbEncoding& encoding,
                                                  const std::array<double, 3>& color);

/// Display P3: primaries of DCI-P3 under D65. Source: [EG432-1]; the curve is sRGB's.
[[nodiscard]] RgbPrimaries display_p3_primaries();

/// Source: [AdobeRGB1998] §4.2.
[[nodiscard]] RgbPrimaries adobe_rgb_primaries();
[[nodiscard]] RgbEncoding adobe_rgb();

/// Encodings by the names that MaterialX has for them. Source: [MaterialX2024], Color Spaces and
/// Color Management Systems.
[[nodiscard]] std::optional<RgbEncoding> rgb_encoding_named(std::string_view name);

/// The name among rgb_encoding_names of an encoding that has others: "acescg" of "lin_ap1".
[[nodiscard]] std::string_view usual_rgb_encoding_name(std::string_view name);

/// The names that rgb_encoding_named knows, but for other ones of the same.
[[nodiscard]] std::span<const std::string_view> rgb_encoding_names();

}  // namespace lamina
