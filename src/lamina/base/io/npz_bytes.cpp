// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/base/io/npz_bytes.h"

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

#include "lamina/base/core/checked_size.h"

namespace lamina {
namespace {

/// Appends a whole number, least byte first.
template <class T>
void put(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
}

/// The sum that ZIP checks files by: CRC-32 of polynomial 0xedb88320, bits reflected.
std::uint32_t crc_32(const std::string& bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> values{};
    for (std::uint32_t i = 0; i < values.size(); ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ ((value & 1) ? 0xedb88320u : 0u);
      values[i] = value;
    }
    return values;
  }();
  std::uint32_t sum = 0xffffffffu;
  for (const char c : bytes) sum = sum >> 8 ^ table[(sum ^ static_cast<unsigned char>(c)) & 0xff];
  return ~sum;
}

std::string npy_bytes(const NpzArray& array) {
  std::string shape;
  std::size_t count = 1;
  for (const std::size_t size : array.shape) {
    shape += std::to_string(size) + ", ";
    count = checked_product("an array", {count, size});
  }
  assert(count == array.values.size());
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + shape + "), }";
  constexpr std::size_t before = 10, alignment = 64;  // bytes of magic, version and length
  while ((before + header.size() + 1) % alignment != 0) header += ' ';
  header += '\n';
  std::string bytes = std::string("\x93NUMPY\x01", 7) + '\0';
  put(bytes, static_cast<std::uint16_t>(header.size()));
  bytes += header;
  for (const double value : array.values) put(bytes, std::bit_cast<std::uint64_t>(value));
  return bytes;
}

/// What the header of a file and the directory say alike.
std::string entry_bytes(const std::string& name, const std::string& content) {
  constexpr std::uint16_t version = 20, no_flags = 0, stored = 0;
  constexpr std::uint16_t midnight = 0, first_of_1980 = 0x21;
  std::string bytes;
  put(bytes, version);
  put(bytes, no_flags);
  put(bytes, stored);
  put(bytes, midnight);
  put(bytes, first_of_1980);
  put(bytes, crc_32(content));
  put(bytes, static_cast<std::uint32_t>(content.size()));
  put(bytes, static_cast<std::uint32_t>(content.size()));
  put(bytes, static_cast<std::uint16_t>(name.size()));
  put(bytes, std::uint16_t{0});  // nothing extra
  return bytes;
}

}  // namespace

std::string npz_bytes(std::span<const NpzArray> arrays) {
  std::string bytes, directory;
  for (const NpzArray& array : arrays) {
    const std::string name = array.name + ".npy", content = npy_bytes(array);
    const std::string entry = entry_bytes(name, content);
    put(directory, std::uint32_t{0x02014b50});
    put(directory, std::uint16_t{20});  // made by version 2.0 for MS-DOS, which has no permissions
    directory += entry;
    put(directory, std::uint16_t{0});  // no comment
    put(directory, std::uint16_t{0});  // on the first disk
    put(directory, std::uint16_t{0});  // attributes
    put(directory, std::uint32_t{0});
    put(directory, static_cast<std::uint32_t>(bytes.size()));
    directory += name;
    put(bytes, std::uint32_t{0x04034b50});
    bytes += entry + name + content;
  }
  const auto count = static_cast<std::uint16_t>(arrays.size());
  const auto start = static_cast<std::uint32_t>(bytes.size());
  bytes += directory;
  put(bytes, std::uint32_t{0x06054b50});
  put(bytes, std::uint16_t{0});
  put(bytes, std::uint16_t{0});
  put(bytes, count);
  put(bytes, count);
  put(bytes, static_cast<std::uint32_t>(directory.size()));
  put(bytes, start);
  put(bytes, std::uint16_t{0});
  return bytes;
}

}  // namespace lamina
