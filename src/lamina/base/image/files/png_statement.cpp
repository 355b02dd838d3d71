// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/png_statement.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lamina/base/image/files/internal/exif.h"
#include "lamina/base/spectrum/rgb_space.h"

namespace lamina {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t most_profile_bytes = std::size_t{1} << 24;  ///< a table of 33^3 is 216 kB

std::uint32_t big_endian(Bytes bytes) {
  std::uint32_t value = 0;
  for (const std::byte b : bytes) value = value << 8 | std::to_integer<std::uint32_t>(b);
  return value;
}

/// The data of the first chunk of that name; empty: there is none.
/// @param before_pixels  whether it says nothing after them
Bytes find_chunk(Bytes file, std::string_view wanted, bool before_pixels) {
  constexpr std::size_t signature = 8, around = 12;  // length, name and checksum
  for (std::size_t at = signature; at + around <= file.size();) {
    const std::size_t length = big_endian(file.subspan(at, 4));
    if (length > file.size() - at - around) break;  // which the decoder refuses
    const std::string_view name(reinterpret_cast<const char*>(file.data()) + at + 4, 4);
    if (name == wanted) return file.subspan(at + 8, length);
    if (name == "IEND" || (before_pixels && name == "IDAT")) break;
    at += around + length;
  }
  return {};
}

/// What zlib has shrunk; empty where it is damaged or would be longer than `most`.
std::vector<std::byte> inflated(Bytes bytes, std::size_t most) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return {};
  std::vector<std::byte> result;
  std::array<std::byte, 1 << 15> piece{};
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    state = inflate(&stream, Z_NO_FLUSH);
    const std::size_t got = piece.size() - stream.avail_out;
    if ((state != Z_OK && state != Z_STREAM_END) || got > most - result.size()) {
      state = Z_DATA_ERROR;
      break;
    }
    result.insert(result.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(got));
    if (state == Z_OK && got == 0) state = Z_DATA_ERROR;  // it is cut
  }
  inflateEnd(&stream);
  if (state != Z_STREAM_END) result.clear();
  return result;
}

/// Primaries by their code. Source: [H273] Table 2.
std::optional<RgbPrimaries> primaries_of_code(int code) {
  const RgbPrimaries::Xy d65{0.3127, 0.3290};
  switch (code) {
    case 1:
      return rec709_primaries();
    case 5:
      return RgbPrimaries{{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, d65};
    case 6:
    case 7:
      return RgbPrimaries{{0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, d65};
    case 9:
      return RgbPrimaries{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, d65};
    case 11:
      return RgbPrimaries{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, {0.314, 0.351}};
    case 12:
      return display_p3_primaries();
    case 22:
      return RgbPrimaries{{0.630, 0.340}, {0.295, 0.605}, {0.155, 0.077}, d65};
    default:
      return std::nullopt;
  }
}

/// Curves by their code. Source: [H273] Table 3.
std::optional<RgbCurve> curve_of_code(int code) {
  switch (code) {
    case 1:
    case 6:
    case 14:
    case 15:
      return RgbCurve{.kind = RgbCurve::Kind::rec709};
    case 4:
      return RgbCurve{.exponent = 2.2};
    case 5:
      return RgbCurve{.exponent = 2.8};
    case 8:
      return RgbCurve{};
    case 13:
      return RgbCurve{.kind = RgbCurve::Kind::srgb};
    default:
      return std::nullopt;
  }
}

ColorStatement statement_of_code_points(Bytes chunk) {
  ColorStatement said;
  if (chunk.size() != 4) return {.refusal = "its chunk cICP is damaged"};
  std::array<int, 4> codes{};
  std::ranges::transform(chunk, codes.begin(), [](std::byte b) { return std::to_integer<int>(b); });
  const auto primaries = primaries_of_code(codes[0]);
  const auto curve = curve_of_code(codes[1]);
  const auto refuse = [&](const std::string& what, int code) {
    said.refusal = "its chunk cICP says " + what + " " + std::to_string(code) +
                   (code == 16   ? " (PQ)"
                    : code == 18 ? " (HLG)"
                                 : "") +
                   ", which lamina does not read";
  };
  if (!primaries)
    refuse("primaries", codes[0]);
  else if (!curve)
    refuse("transfer function", codes[1]);
  else if (codes[2] != 0)
    refuse("matrix", codes[2]);
  else if (codes[3] != 1)
    said.refusal = "its chunk cICP says a narrow range, which lamina does not read";
  else
    said.encoding = RgbEncoding{*primaries, *curve};
  return said;
}

ColorStatement statement_of_profile(const EncodedImage& file, Bytes chunk) {
  ColorStatement said;
  const auto name =
      static_cast<std::size_t>(std::ranges::find(chunk, std::byte{0}) - chunk.begin());
  if (name + 2 <= chunk.size())
    said.icc = inflated(chunk.subspan(name + 2), std::min(most_profile_bytes, file.memory.left));
  if (said.icc.empty()) said.refusal = "its chunk iCCP is damaged or longer than 16 MiB";
  return said;
}

ColorStatement statement_of_gamma(Bytes gamma, Bytes chromaticities) {
  RgbEncoding encoding;
  if (chromaticities.size() == 32) {
    const auto xy = [&](std::size_t i) {
      return RgbPrimaries::Xy{big_endian(chromaticities.subspan(8 * i, 4)) / 100000.0,
                              big_endian(chromaticities.subspan(8 * i + 4, 4)) / 100000.0};
    };
    encoding.primaries = {.red = xy(1), .green = xy(2), .blue = xy(3), .white = xy(0)};
  }
  const std::uint32_t value = gamma.size() == 4 ? big_endian(gamma) : 0;
  constexpr std::uint32_t of_srgb = 45455;
  const bool is_srgb =
      value == 0 || (value == of_srgb && are_alike(encoding.primaries, rec709_primaries()));
  if (!is_srgb) encoding.curve = RgbCurve{.exponent = 100000.0 / value};
  if (value > 0 && !(100000.0 / value >= 0.1 && 100000.0 / value <= 10.0))
    return {.refusal = "its chunk gAMA says " + std::to_string(value / 100000.0) +
                       ", which must lie in [0.1, 10]"};
  return {.encoding = encoding};
}

}  // namespace

ColorStatement png_color_statement(const EncodedImage& file) {
  if (!follows_statement(file.encoding)) return {};
  const auto chunk = [&](std::string_view name) { return find_chunk(file.bytes, name, true); };
  if (const Bytes code_points = chunk("cICP"); !code_points.empty())
    return statement_of_code_points(code_points);
  if (const Bytes profile = chunk("iCCP"); !profile.empty())
    return statement_of_profile(file, profile);
  if (!chunk("sRGB").empty()) return {};
  const Bytes gamma = chunk("gAMA"), chromaticities = chunk("cHRM");
  if (gamma.empty() && chromaticities.empty()) return {};
  return statement_of_gamma(gamma, chromaticities);
}

int png_orientation(std::span<const std::byte> bytes) {
  return parse_exif(find_chunk(bytes, "eXIf", false)).orientation;
}

}  // namespace lamina
