// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/internal/checkpoint.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>

#include "lamina/core/error.h"
#include "lamina/core/hash.h"
#include "lamina/io/file_bytes.h"

// The file is for the machine that wrote it: a header, the tiles, and the film as it lies in
// memory.
namespace lamina {
namespace {

struct Header {
  std::array<char, 16> magic = {'l', 'a', 'm', 'i', 'n', 'a', ' ', 'f', 'i', 'l', 'm', ' ', '3'};
  std::uint64_t checksum = 0;  ///< of all that comes behind it
  std::uint64_t key = 0, tiles = 0, film_bytes = 0;
  std::int64_t from = 0;
  double noise = 0.0;
  std::uint64_t light = 0;
};
constexpr std::size_t up_to_checksum = offsetof(Header, checksum) + sizeof(Header::checksum);

std::uint64_t checksum(std::span<const std::byte> file) {
  Hash hash;
  hash.add_bytes(file.subspan(up_to_checksum));
  return hash.value();
}

}  // namespace

void save_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                     const FilmAccumulator& film, const TileProgress& tiles) {
  const std::span<const std::byte> pixels = film.bytes();
  Header header{.key = key,
                .tiles = tiles.samples.size(),
                .film_bytes = pixels.size(),
                .from = tiles.from,
                .noise = static_cast<double>(tiles.noise),
                .light = tiles.light};
  std::vector<std::byte> bytes(sizeof header);
  const auto append = [&](std::span<const std::byte> part) {
    bytes.insert(bytes.end(), part.begin(), part.end());
  };
  append(std::as_bytes(std::span(tiles.samples)));
  append(std::as_bytes(std::span(tiles.is_quiet)));
  append(pixels);
  std::memcpy(bytes.data(), &header, sizeof header);
  header.checksum = checksum(bytes);
  std::memcpy(bytes.data(), &header, sizeof header);
  write_file_bytes(file, bytes);
}

std::optional<TileProgress> load_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                                            FilmAccumulator& film) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  constexpr std::size_t per_tile = sizeof(std::int32_t) + sizeof(std::uint8_t);
  const std::size_t most_tiles = film.bytes().size();  // a tile has a pixel
  MemoryBudget memory{sizeof(Header) + film.bytes().size() + most_tiles * per_tile};
  const std::string text = read_file_bytes(file, memory);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  Header header;
  const auto magic = header.magic;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  if (bytes.size() < sizeof header || header.magic != magic)
    throw FileError(file.string() + ": is not an unfinished image of this version");
  const auto refuse = [&](const std::string& why) {
    throw FileError(file.string() + ": " + why + "; remove it, or render without --resume");
  };
  if (header.checksum != checksum(bytes)) refuse("is damaged");
  if (header.key != key)
    refuse("is an unfinished image of another scene, other settings or another version of lamina");
  const std::span<const std::byte> body = bytes.subspan(sizeof header);
  if (header.tiles > body.size() || header.film_bytes != film.bytes().size() ||
      body.size() != header.tiles * per_tile + header.film_bytes)
    refuse("is damaged");
  TileProgress tiles{.from = static_cast<int>(header.from),
                     .samples = std::vector<std::int32_t>(header.tiles),
                     .is_quiet = std::vector<std::uint8_t>(header.tiles),
                     .noise = static_cast<float>(header.noise),
                     .light = header.light};
  const std::byte* at = body.data();
  std::memcpy(tiles.samples.data(), at, header.tiles * sizeof(std::int32_t));
  at += header.tiles * sizeof(std::int32_t);
  std::memcpy(tiles.is_quiet.data(), at, header.tiles);
  film.restore({at + header.tiles, header.film_bytes});
  return tiles;
}

}  // namespace lamina
