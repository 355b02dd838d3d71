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

/// A number of up to 8 bytes with copies of its sign above; `end` is that of all that may be read.
std::int64_t read_number(const std::byte* from, std::size_t width, const std::byte* end) {
  std::uint64_t head = 0;
  if (end - from >= 8)
    std::memcpy(&head, from, 8);  // of a width that is known, so one instruction
  else
    std::memcpy(&head, from, width);
  const auto up = static_cast<int>(64 - 8 * width);
  return static_cast<std::int64_t>(head << up) >> up;
}

/// A number of `width` bytes from the byte `low` on, zeros below and its sign above.
Words unpack(const std::byte* from, std::size_t low, std::size_t width) {
  const bool is_negative = (std::to_integer<unsigned>(from[width - 1]) & 0x80u) != 0;
  std::array<std::byte, widest> bytes{};
  std::memcpy(bytes.data() + low, from, width);
  std::memset(bytes.data() + low + width, is_negative ? 0xff : 0, widest - low - width);
  Words words{};
  std::memcpy(words.data(), bytes.data(), widest);
  return words;
}

/// sum += term, both in two's complement, lowest word first.
template <std::size_t Count>
void add_words(std::uint64_t* sum, const std::uint64_t* term) {
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < Count; ++i) {
    const std::uint64_t with_carry = term[i] + carry;
    sum[i] += with_carry;
    carry = (with_carry < carry ? 1u : 0u) + (sum[i] < with_carry ? 1u : 0u);
  }
}

/// Adds numbers of `width` bytes from the byte `low` on to sums of `Count` words each.
template <std::size_t Count>
void add_numbers(std::span<const std::byte> numbers, std::size_t low, std::size_t width,
                 std::span<std::uint64_t> sums) {
  const std::byte* from = numbers.data();
  const std::byte* const numbers_end = from + numbers.size();
  const std::size_t first = low / 8;
  if (first >= Count) return;  // all of them are 0
  const std::uint64_t* const end = sums.data() + sums.size();
  if (width > 8) {
    for (std::uint64_t* sum = sums.data(); sum != end; sum += Count, from += width)
      add_words<Count>(sum, unpack(from, low, width).data());
    return;
  }
  const auto up = static_cast<int>(8 * (low % 8));
  for (std::uint64_t* sum = sums.data(); sum != end; sum += Count, from += width) {
    const std::int64_t number = read_number(from, width, numbers_end);
    Words term{};
    term[first] = static_cast<std::uint64_t>(number) << up;
    if (first + 1 < Count)  // shifted twice, as by 64 at once is none
      term[first + 1] = static_cast<std::uint64_t>(number >> (63 - up) >> 1);
    if (first + 2 < Count) term[first + 2] = number < 0 ? ~std::uint64_t{0} : 0;
    add_words<Count>(sum, term.data());
  }
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

PlaneSum::PlaneSum(const FilmPlane& plane, std::size_t pixels)
    : plane_(&plane), words_((plane.bytes + 7) / 8), sums_(words_ * pixels) {}

bool PlaneSum::add_packed(std::span<const std::byte> packed) {
  if (packed.size() < header_bytes) return false;
  const auto low = std::to_integer<std::size_t>(packed[0]);
  const auto width = std::to_integer<std::size_t>(packed[1]);
  if (width == 0 || low + width > widest ||
      packed.size() != header_bytes + width * (sums_.size() / words_))
    return false;
  const std::span<const std::byte> numbers = packed.subspan(header_bytes);
  switch (words_) {
    case 1:
      add_numbers<1>(numbers, low, width, sums_);
      break;
    case 2:
      add_numbers<2>(numbers, low, width, sums_);
      break;
    default:
      add_numbers<3>(numbers, low, width, sums_);
      break;
  }
  return true;
}

void PlaneSum::store(std::span<FilmPixel> pixels) const {
  const std::uint64_t* sum = sums_.data();
  for (FilmPixel& pixel : pixels) {
    std::memcpy(reinterpret_cast<std::byte*>(&pixel) + plane_->place, sum, plane_->bytes);
    sum += words_;
  }
}

}  // namespace lamina
