// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lamina/base/core/enum_names.h"
#include "lamina/base/image/image.h"

namespace lamina {

/// Why a pixel is not used; one may have several.
enum class PixelFault : std::uint8_t {
  excluded = 1,     ///< by the user's mask, or outside of the window
  edge = 2,         ///< too near to what is excluded
  not_finite = 4,   ///< infinite or NaN in some band
  saturated = 8,    ///< at the top of the sensor in some band
  specular = 16,    ///< mirrors the light
  dark_white = 32,  ///< the white reference is too dark there
  unseen = 64,      ///< a band shows nothing there once it is registered
};

template <>
inline constexpr auto enum_names<PixelFault> =
    std::to_array<EnumName<PixelFault>>({{"excluded", PixelFault::excluded},
                                         {"edge", PixelFault::edge},
                                         {"not_finite", PixelFault::not_finite},
                                         {"saturated", PixelFault::saturated},
                                         {"specular", PixelFault::specular},
                                         {"dark_white", PixelFault::dark_white},
                                         {"unseen", PixelFault::unseen}});

/// Pixels of an image that are used.
struct PixelMask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> faults;  ///< [y][x] sum of PixelFault; 0: used

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool is_used(int x, int y) const { return faults[index(x, y)] == 0; }
  void mark(std::size_t pixel, PixelFault fault) {
    faults[pixel] = static_cast<std::uint8_t>(faults[pixel] | static_cast<unsigned>(fault));
  }
};

/// All pixels are used.
[[nodiscard]] PixelMask make_pixel_mask(int width, int height);

/// Pixels below a half in "Y", the only or the first channel are excluded, as in masks that people
/// paint, and as in the pattern of a window.
[[nodiscard]] PixelMask mask_from_image(const Image& image);

/// Used are the pixels that both use. @throws InvalidInput if they differ in size.
[[nodiscard]] PixelMask combined(const PixelMask& a, const PixelMask& b);

/// Leaves out so many pixels, `edge`, around those that are excluded, in rows, columns and
/// diagonals: there light comes from below the tape, and pixels are partly of it.
/// @param pixels  >= 0
[[nodiscard]] PixelMask eroded(PixelMask mask, int pixels);

/// How many pixels are used, and have each fault.
struct MaskCounts {
  std::size_t used = 0;
  std::array<std::size_t, enum_names<PixelFault>.size()> faults{};  ///< in the order of the names
};
[[nodiscard]] MaskCounts count_pixels(const PixelMask& mask);

/// "93120 pixels used; 412 saturated, 88 specular".
[[nodiscard]] std::string counts_text(const MaskCounts& counts);

/// @param what  the mask, as messages call it. @throws InvalidInput with the counts if no pixel is
///              used.
void require_used_pixels(const PixelMask& mask, const std::string& what);

}  // namespace lamina
