// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/jpeg_notes.h"

#include <map>
#include <string_view>

namespace lamina {
namespace {

using namespace std::string_view_literals;

struct JpegProfilePieces {
  std::map<int, std::span<const std::byte>> pieces;  ///< by their number, from 1
  int count = 0;
  bool is_damaged = false;

  void add(std::span<const std::byte> data) {
    if (data.size() < 2) {
      is_damaged = true;
      return;
    }
    const int number = std::to_integer<int>(data[0]), of = std::to_integer<int>(data[1]);
    if (count == 0) count = of;
    if (of != count || number < 1 || number > of || !pieces.emplace(number, data.subspan(2)).second)
      is_damaged = true;
  }

  [[nodiscard]] ColorStatement statement() const {
    ColorStatement said;
    if (is_damaged || pieces.size() != static_cast<std::size_t>(count)) {
      said.refusal = "its ICC profile is damaged: it has " + std::to_string(pieces.size()) +
                     " of " + std::to_string(count) + " pieces";
      return said;
    }
    for (const auto& [number, piece] : pieces)
      said.icc.insert(said.icc.end(), piece.begin(), piece.end());
    return said;
  }
};

}  // namespace

JpegNotes read_jpeg_notes(const EncodedImage& file) {
  const std::span<const std::byte> bytes = file.bytes;
  const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  JpegNotes notes;
  JpegProfilePieces profile;
  constexpr unsigned scan = 0xDA, end = 0xD9, app1 = 0xE1, app2 = 0xE2;
  for (std::size_t i = 2; i + 4 <= bytes.size();) {
    if (at(i) != 0xFF) break;
    const unsigned marker = at(i + 1);
    if (marker == 0xFF) {  // filling
      ++i;
      continue;
    }
    if (marker == scan || marker == end) break;
    const std::size_t length = at(i + 2) << 8 | at(i + 3);
    if (length < 2 || length > bytes.size() - i - 2) break;
    const std::span<const std::byte> data = bytes.subspan(i + 4, length - 2);
    const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
    if (marker == app1 && text.starts_with("Exif\0\0"sv))
      notes.exif = parse_exif(data.subspan(6));
    else if (marker == app2 && text.starts_with("ICC_PROFILE\0"sv) &&
             follows_statement(file.encoding))
      profile.add(data.subspan(12));
    i += 2 + length;
  }
  if (profile.count > 0 || profile.is_damaged)
    notes.colors = profile.statement();
  else if (notes.exif.is_adobe_rgb)
    notes.colors.encoding = adobe_rgb();
  return notes;
}

}  // namespace lamina
