// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamina {

/// In which order the numbers of an ENVI file lie.
enum class EnviInterleave {
  bsq,  ///< [band][y][x]
  bil,  ///< [y][band][x]
  bip,  ///< [y][x][band]
};

/// Header of an ENVI file: the text beside the numbers of a camera of many bands.
struct EnviHeader {
  std::size_t samples = 0, lines = 0, bands = 0;  ///< >= 1; width, height
  std::uint64_t offset = 0;                       ///< bytes before the numbers
  int data_type = 0;  ///< 1: uint8, 2: int16, 3: int32, 4: float, 5: double, 12: uint16, 13: uint32
  EnviInterleave interleave = EnviInterleave::bsq;
  bool is_big_endian = false;
  double scale = 1.0;               ///< a number over this is the reflectance; > 0
  std::optional<double> ignored;    ///< the number that stands for no data
  std::vector<double> wavelengths;  ///< [band] [nm]; empty if the file names none
  std::vector<double> widths;       ///< [band] [nm] full, at half of the height; may be empty
  std::vector<std::string> names;   ///< [band]; may be empty
  std::vector<bool> is_bad;         ///< [band] those that the file says not to use; may be empty
};

/// Bytes of one number.
[[nodiscard]] std::size_t envi_number_size(const EnviHeader& header);

/// Channel name of a band: its wavelength, "540nm"; else its name, else "band 7".
[[nodiscard]] std::string envi_channel_name(const EnviHeader& header, std::size_t band);

/// @param name  the file that messages name.
/// @throws FileError naming the line or entry that is missing, damaged, or of a kind that is not
///         read: complex and 64 bit integers, wavelengths without a unit of length.
[[nodiscard]] EnviHeader parse_envi_header(std::string_view text, const std::string& name);

}  // namespace lamina
