// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/render/film/film_pixel.h"

namespace lamina {

/// One whole number of a FilmPixel, in two's complement.
struct FilmPlane {
  std::size_t place = 0;  ///< [byte] in the pixel
  std::size_t bytes = 0;  ///< 4, or 8, 16 or 24
  bool is_color = false;  ///< needed for colors, their noise and what is measured
};

inline constexpr std::size_t film_planes = 20;
extern const std::array<FilmPlane, film_planes> all_film_planes;

/// The numbers of a plane without the bytes that say nothing in any of them: zeros below, copies of
/// the sign above.
[[nodiscard]] std::vector<std::byte> pack_plane(const FilmPlane& plane,
                                                std::span<const FilmPixel> pixels);

/// At most so many bytes.
[[nodiscard]] std::size_t most_packed_bytes(std::size_t pixels);

/// Adds packed numbers to those of pixels. @return  false if it is not what pack_plane made of as
/// many pixels; nothing is added then.
[[nodiscard]] bool add_packed(const FilmPlane& plane, std::span<const std::byte> packed,
                              std::span<FilmPixel> pixels);

}  // namespace lamina
