// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/internal/packed_plane.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

// A packed plane: how many bytes below are left out, how many each number has, then the numbers.
namespace lamina {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(std::is_standard_layout_v<FilmPixel> && std::is_trivially_copyable_v<FilmPixel>);
static_assert(sizeof(FilmPixel) == 248);  // all of it lies in planes

constexpr std::size_t header_bytes = 2;
constexpr std::size_t widest = 24;

template <class Sum>
constexpr std::array<FilmPlane, 3> planes_of(std::size_t place, bool is_color) {
  return {{{place, sizeof(Sum), is_color},
           {place + sizeof(Sum), sizeof(Sum), is_color},
           {place + 2 * sizeof(Sum), sizeof(Sum), is_color}}};
}

constexpr std::array<FilmPlane, film_planes> make_planes() {
  std::array<FilmPlane, film_planes> planes{};
  std::size_t count = 0;
  const auto add = [&](std::array<FilmPlane, 3> three) {
    for (const FilmPlane& plane : three) planes[count++] = plane;
  };
  add(planes_of<LightSum>(offsetof(FilmPixel, beauty), true));
  add(planes_of<LightSum>(offsetof(FilmPixel, subsurface), false));
  add(planes_of<LightSum>(offsetof(FilmPixel, specular), false));
  add(planes_of<UnitSum>(offsetof(FilmPixel, normal), false));
  add(planes_of<UnitSum>(offsetof(FilmPixel, albedo), false));
  planes[count++] = {offsetof(FilmPixel, samples), sizeof(FilmPixel::samples), true};
  planes[count++] = {offsetof(FilmPixel, hits), sizeof(FilmPixel::hits), true};
  planes[count++] = {offsetof(FilmPixel, subsurface_hits), sizeof(FilmPixel::subsurface_hits),
                     true};
  planes[count++] = {offsetof(FilmPixel, luminance_square), sizeof(LightSquareSum), true};
  planes[count++] = {offsetof(FilmPixel, depth), sizeof(LightSum), false};
  return planes;
}

using Words = std::array<std::uint64_t, widest / 8>;

/// The number of a pixel with copies of its sign above.
Words load(const FilmPlane& plane, const FilmPixel& pixel) {
  Words words{};
  std::memcpy(words.data(), reinterpret_cast<const std::byte*>(&pixel) + plane.place, plane.bytes);
  if (plane.bytes == 4)
    words[0] = static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(words[0])});
  const std::size_t filled = (plane.bytes + 7) / 8;
  const std::uint64_t sign = words[filled - 1] >> 63 ? ~std::uint64_t{0} : 0;
  for (std::size_t i = filled; i < words.size(); ++i) words[i] = sign;
  return words;
}

/// Adds without a branch on what is stored; 2^24 samples of a pixel fit.
void add_to(const FilmPlane& plane, FilmPixel& pixel, const Words& words) {
  std::byte* at = reinterpret_cast<std::byte*>(&pixel) + plane.place;
  if (plane.bytes == 4) {
    std::uint32_t sum = 0;
    std::memcpy(&sum, at, sizeof sum);
    sum += static_cast<std::uint32_t>(words[0]);
    std::memcpy(at, &sum, sizeof sum);
    return;
  }
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < plane.bytes / 8; ++i) {
    std::uint64_t sum = 0;
    std::memcpy(&sum, at + 8 * i, sizeof sum);
    const std::uint64_t with_carry = words[i] + carry;
    sum += with_carry;
    carry = (with_carry < carry ? 1u : 0u) + (sum < with_carry ? 1u : 0u);
    std::memcpy(at + 8 * i, &sum, sizeof sum);
  }
}

/// A number of `width` bytes from the byte `low` on, zeros below and its sign above.
Words unpack(const std::byte* from, std::size_t low, std::size_t width) {
  std::uint64_t head = 0;
  Words words{};
  if (width <= 8 && low % 8 + width <= 8) {  // in one word, as most are
    std::memcpy(&head, from, width);
    const auto up = static_cast<int>(64 - 8 * width);
    const auto value = static_cast<std::int64_t>(head << up) >> up;
    words[low / 8] = static_cast<std::uint64_t>(value) << (8 * (low % 8));
    for (std::size_t i = low / 8 + 1; i < words.size(); ++i)
      words[i] = value < 0 ? ~std::uint64_t{0} : 0;
    return words;
  }
  const bool is_negative = (std::to_integer<unsigned>(from[width - 1]) & 0x80u) != 0;
  std::array<std::byte, widest> bytes{};
  std::memcpy(bytes.data() + low, from, width);
  std::memset(bytes.data() + low + width, is_negative ? 0xff : 0, widest - low - width);
  std::memcpy(words.data(), bytes.data(), widest);
  return words;
}

}  // namespace

const std::array<FilmPlane, film_planes> all_film_planes = make_planes();

std::vector<std::byte> pack_plane(const FilmPlane& plane, std::span<const FilmPixel> pixels) {
  Words set{}, differs{};  // bits that are set, or differ from the sign, in any number
  for (const FilmPixel& pixel : pixels) {
    const Words words = load(plane, pixel);
    const std::uint64_t sign = words.back() >> 63 ? ~std::uint64_t{0} : 0;
    for (std::size_t i = 0; i < words.size(); ++i) {
      set[i] |= words[i];
      differs[i] |= words[i] ^ sign;
    }
  }
  std::size_t low = 0, bits = 0;
  while (low < widest - 1 && (set[low / 8] >> (8 * (low % 8)) & 0xff) == 0) ++low;
  for (std::size_t i = 0; i < differs.size(); ++i)
    if (differs[i] != 0) bits = 64 * i + static_cast<std::size_t>(std::bit_width(differs[i]));
  const std::size_t high = std::max(bits / 8 + 1, low + 1);  // with a bit for the sign
  const std::size_t width = high - low;
  std::vector<std::byte> packed(header_bytes + width * pixels.size());
  packed[0] = static_cast<std::byte>(low);
  packed[1] = static_cast<std::byte>(width);
  std::byte* to = packed.data() + header_bytes;
  for (const FilmPixel& pixel : pixels) {
    const Words words = load(plane, pixel);
    std::memcpy(to, reinterpret_cast<const std::byte*>(words.data()) + low, width);
    to += width;
  }
  return packed;
}

std::size_t most_packed_bytes(std::size_t pixels) { return header_bytes + widest * pixels; }

bool add_packed(const FilmPlane& plane, std::span<const std::byte> packed,
                std::span<FilmPixel> pixels) {
  if (packed.size() < header_bytes) return false;
  const auto low = std::to_integer<std::size_t>(packed[0]);
  const auto width = std::to_integer<std::size_t>(packed[1]);
  if (width == 0 || low + width > widest || packed.size() != header_bytes + width * pixels.size())
    return false;
  const std::byte* from = packed.data() + header_bytes;
  for (FilmPixel& pixel : pixels) {
    add_to(plane, pixel, unpack(from, low, width));
    from += width;
  }
  return true;
}

}  // namespace lamina
