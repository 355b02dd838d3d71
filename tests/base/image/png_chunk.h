// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lamina {

/// Writes a PNG with one more chunk, right after its header.
/// @param chunk  its name and its data
inline void write_png_with_chunk(const std::filesystem::path& file,
                                 const std::vector<std::byte>& png, const std::string& chunk) {
  std::uint32_t checksum = ~0u;  // Source: W3C PNG, annex D
  for (const char letter : chunk) {
    checksum ^= static_cast<unsigned char>(letter);
    for (int bit = 0; bit < 8; ++bit)
      checksum = checksum & 1u ? 0xEDB88320u ^ (checksum >> 1) : checksum >> 1;
  }
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  std::string text(reinterpret_cast<const char*>(png.data()), png.size());
  constexpr std::size_t after_header = 8 + 25;
  text.insert(after_header,
              number(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk + number(~checksum));
  std::ofstream(file, std::ios::binary) << text;
}

/// The data of chunks that tests write.
inline const std::string display_p3_chunk = std::string("cICP\x0c\x0d\x00\x01", 8);
inline const std::string light_chunk = std::string("gAMA\x00\x01\x86\xa0", 8);

/// A chunk eXIf that notes an orientation.
inline std::string orientation_chunk(char orientation) {
  std::string chunk("eXIfMM\x00\x2a\x00\x00\x00\x08\x00\x01\x01\x12\x00\x03\x00\x00\x00\x01\x00",
                    23);
  chunk += orientation;
  return chunk + std::string(6, '\0');
}

}  // namespace lamina
