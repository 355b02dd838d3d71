// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/image/files/internal/codec.h"
#include "lamina/base/spectrum/rgb_encoding.h"

// The one door of colors: whatever a file says of its numbers, codecs tell a ColorReading, which
// weighs it against what the user says, and makes linear Rec.709 of them.

namespace lamina {

/// Statement of a file about its colors. An ICC profile counts before an encoding.
struct ColorStatement {
  std::vector<std::byte> icc;           ///< empty: none
  std::optional<RgbEncoding> encoding;  ///< by chunks of PNG or by Exif
  std::string refusal;                  ///< why what it says cannot be followed; empty: it can
};

/// Whether colors of this encoding are what the file says that they are.
[[nodiscard]] constexpr bool follows_statement(ColorEncoding encoding) {
  return encoding == ColorEncoding::srgb || encoding == ColorEncoding::linear_colors;
}

class IccTransform;

/// How the numbers of a file become light.
///
/// - `srgb`: as the file says, which is sRGB for integers and light for floating point numbers of a
///   file that says nothing.
/// - `linear_colors`: light, of the primaries of the file where it says that its numbers are light.
/// - an encoding by name: that, whatever the file says.
/// - `linear` and `srgb_numbers`: quantities, of which a file of colors cannot say anything.
class ColorReading {
 public:
  /// @param format  of the file, for messages
  /// @throws FileError for a profile that is damaged or not of colors such as these
  ColorReading(const EncodedImage& file, const char* format, const ColorStatement& said,
               bool is_grey, bool is_float);
  ~ColorReading();
  ColorReading(const ColorReading&) = delete;
  ColorReading& operator=(const ColorReading&) = delete;

  /// Number of an integer as it is read, as a fraction of the largest one.
  [[nodiscard]] float number(std::uint32_t value, std::uint32_t largest) const;

  /// Converts the colors of the image, its first channels, "Y" or "R", "G", "B", to Rec.709.
  /// Negative numbers that only this makes, of colors beyond the triangle of Rec.709, become 0.
  [[nodiscard]] Image in_rec709(Image image) const;

 private:
  RgbCurve curve_;        ///< of each number
  RgbCurve float_curve_;  ///< of each floating point number, which has not met `curve_`
  std::optional<Matrix3> matrix_;
  std::unique_ptr<IccTransform> icc_;
};

}  // namespace lamina
