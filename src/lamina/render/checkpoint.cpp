// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/checkpoint.h"

#include <array>
#include <cstring>
#include <span>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/file_bytes.h"

// The file is for the machine that wrote it: a header, the tiles, and the film as it lies in
// memory.
namespace lamina {
namespace {

struct Header {
  std::array<char, 16> magic = {'l', 'a', 'm', 'i', 'n', 'a', ' ', 'f', 'i', 'l', 'm', ' ', '1'};
  std::uint64_t key = 0, tiles = 0, film_bytes = 0, checksum = 0;
  std::int64_t from = 0;
};

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325u;  // FNV-1a, by words
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    sum = (sum ^ word) * 0x100000001b3u;
  }
  return sum;
}

}  // namespace

void save_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                     const FilmAccumulator& film, const TileProgress& tiles) {
  const std::span<const std::byte> pixels = film.bytes();
  Header header{
      .key = key, .tiles = tiles.samples.size(), .film_bytes = pixels.size(), .from = tiles.from};
  std::vector<std::byte> bytes(sizeof header);
  const auto append = [&](std::span<const std::byte> part) {
    bytes.insert(bytes.end(), part.begin(), part.end());
  };
  append(std::as_bytes(std::span(tiles.samples)));
  append(std::as_bytes(std::span(tiles.is_quiet)));
  append(pixels);
  header.checksum = checksum(std::span(bytes).subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  write_file_bytes(file, bytes);
}

std::optional<TileProgress> load_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                                            FilmAccumulator& film) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::string text = read_file_bytes(file);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  Header header;
  const auto magic = header.magic;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (bytes.size() < sizeof header || header.magic != magic)
    throw FileError(file.string() + ": is not an unfinished image of this version");
  if (header.key != key)
    throw FileError(file.string() +
                    ": is an unfinished image of another scene or other settings; remove it, or "
                    "render without --resume");
  const std::span<const std::byte> body = bytes.subspan(sizeof header);
  constexpr std::size_t per_tile = sizeof(std::int32_t) + sizeof(std::uint8_t);
  if (header.tiles > body.size() || header.film_bytes != film.bytes().size() ||
      body.size() != header.tiles * per_tile + header.film_bytes ||
      header.checksum != checksum(body))
    throw FileError(file.string() + ": is damaged");
  TileProgress tiles{.from = static_cast<int>(header.from),
                     .samples = std::vector<std::int32_t>(header.tiles),
                     .is_quiet = std::vector<std::uint8_t>(header.tiles)};
  const std::byte* at = body.data();
  std::memcpy(tiles.samples.data(), at, header.tiles * sizeof(std::int32_t));
  at += header.tiles * sizeof(std::int32_t);
  std::memcpy(tiles.is_quiet.data(), at, header.tiles);
  film.restore({at + header.tiles, header.film_bytes});
  return tiles;
}

}  // namespace lamina
