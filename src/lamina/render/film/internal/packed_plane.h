// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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
inline constexpr std::size_t samples_plane = 15, hits_plane = 16;  ///< of FilmPixel's members
extern const std::array<FilmPlane, film_planes> all_film_planes;

/// The numbers of a plane without the bytes that say nothing in any of them: zeros below, copies of
/// the sign above.
[[nodiscard]] std::vector<std::byte> pack_plane(const FilmPlane& plane,
                                                std::span<const FilmPixel> pixels);

/// At most so many bytes.
[[nodiscard]] std::size_t most_packed_bytes(std::size_t pixels);

/// Sums of one number over files, for each of some pixels. They lie one behind another, as whole
/// pixels are too far apart to be added to at the speed of reading.
class PlaneSum {
 public:
  PlaneSum(const FilmPlane& plane, std::size_t pixels);

  /// Adds packed numbers, modulo 2^64 in each word. @return  false if they are not what pack_plane
  /// made of as many pixels; nothing is added then.
  [[nodiscard]] bool add_packed(std::span<const std::byte> packed);

  /// The lowest word of the sum of a pixel.
  [[nodiscard]] std::int64_t low_word(std::size_t pixel) const {
    return static_cast<std::int64_t>(sums_[pixel * words_]);
  }

  void store(std::span<FilmPixel> pixels) const;

 private:
  const FilmPlane* plane_;
  std::size_t words_;                ///< of each sum
  std::vector<std::uint64_t> sums_;  ///< [pixel][word], lowest first
};

}  // namespace lamina
