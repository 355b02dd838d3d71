// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/image/files/internal/exif.h"

#include <cstdint>
#include <optional>
#include <string>

namespace lamina {
namespace {

/// A TIFF in memory, whose numbers lie in the order of its first bytes; 0 beyond its end.
class ExifTables {
 public:
  explicit ExifTables(std::span<const std::byte> bytes) : bytes_(bytes) {
    is_big_endian_ = at(0) == 'M' && at(1) == 'M';
    is_valid_ = (is_big_endian_ || (at(0) == 'I' && at(1) == 'I')) && number(2, 2) == 42;
  }

  [[nodiscard]] bool is_valid() const { return is_valid_; }
  [[nodiscard]] std::size_t first_table() const { return number(4, 4); }

  /// Where the value of a tag lies in a table.
  [[nodiscard]] std::optional<std::size_t> find(std::size_t table, unsigned tag) const {
    const std::size_t entries = table < bytes_.size() ? number(table, 2) : 0;
    for (std::size_t i = 0; i < entries; ++i) {
      const std::size_t entry = table + 2 + 12 * i;
      if (entry + 12 > bytes_.size()) return std::nullopt;
      if (number(entry, 2) == tag) return entry + 8;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::size_t number(std::size_t place, int size) const {
    std::size_t value = 0;
    for (int i = 0; i < size; ++i) {
      const auto from = place + static_cast<std::size_t>(is_big_endian_ ? i : size - 1 - i);
      value = value << 8 | at(from);
    }
    return value;
  }

  [[nodiscard]] unsigned char at(std::size_t place) const {
    return place < bytes_.size() ? std::to_integer<unsigned char>(bytes_[place])
                                 : static_cast<unsigned char>(0);
  }

 private:
  std::span<const std::byte> bytes_;
  bool is_big_endian_ = false, is_valid_ = false;
};

}  // namespace

ExifNotes parse_exif(std::span<const std::byte> bytes) {
  constexpr unsigned orientation = 0x112, exif = 0x8769, interoperability = 0xA005,
                     color_space = 0xA001, index = 1, adobe_rgb = 2;
  ExifNotes notes;
  const ExifTables tables(bytes);
  if (!tables.is_valid()) return notes;
  const std::size_t first = tables.first_table();
  if (const auto found = tables.find(first, orientation)) {
    const std::size_t value = tables.number(*found, 2);
    if (value >= 1 && value <= 8) notes.orientation = static_cast<int>(value);
  }
  const auto camera = tables.find(first, exif);
  if (!camera) return notes;
  const std::size_t table = tables.number(*camera, 4);
  const auto space = tables.find(table, color_space);
  if (space && tables.number(*space, 2) == adobe_rgb) notes.is_adobe_rgb = true;
  const auto rules = tables.find(table, interoperability);
  if (!rules) return notes;
  if (const auto found = tables.find(tables.number(*rules, 4), index)) {
    std::string name;
    for (std::size_t i = 0; i < 3; ++i) name += static_cast<char>(tables.at(*found + i));
    if (name == "R03") notes.is_adobe_rgb = true;
  }
  return notes;
}

}  // namespace lamina
