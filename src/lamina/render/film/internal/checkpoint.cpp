// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/film/internal/checkpoint.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/hash.h"
#include "lamina/base/io/file_parts.h"
#include "lamina/render/film/tile_passes.h"

// The file is for the machine that wrote it: a header, the tiles, and the film as it lies in
// memory.
namespace lamina {
namespace {

struct Header {
  std::array<char, 16> magic = {'l', 'a', 'm', 'i', 'n', 'a', ' ', 'f', 'i', 'l', 'm', ' ', '4'};
  std::uint64_t checksum = 0;  ///< of all that comes behind it
  std::uint64_t key = 0, tiles = 0, film_bytes = 0;
  std::int64_t from = 0;
  double noise = 0.0;
  std::uint64_t light = 0;
};
constexpr std::size_t up_to_checksum = offsetof(Header, checksum) + sizeof(Header::checksum);

std::uint64_t checksum(const Header& header, const TileProgress& tiles,
                       const FilmAccumulator& film) {
  Hash hash;
  hash.add_bytes(std::as_bytes(std::span(&header, 1)).subspan(up_to_checksum));
  hash.add_bytes(std::as_bytes(std::span(tiles.samples)));
  hash.add_bytes(std::as_bytes(std::span(tiles.is_quiet)));
  hash.add_bytes(film.bytes());
  return hash.value();
}

}  // namespace

std::optional<KeptSamples> kept_samples(const std::filesystem::path& file) {
  try {
    const FileParts parts(file);
    Header header;
    const auto magic = header.magic;
    if (parts.size() < sizeof header) return std::nullopt;
    parts.read(0, std::as_writable_bytes(std::span(&header, 1)));
    const std::uint64_t behind = parts.size() - sizeof header;
    if (header.magic != magic || header.tiles == 0 || header.tiles > behind / sizeof(std::int32_t))
      return std::nullopt;
    std::vector<std::int32_t> samples(header.tiles);
    parts.read(sizeof header, std::as_writable_bytes(std::span(samples)));
    const auto [least, most] = std::ranges::minmax(samples);
    return KeptSamples{least, most};
  } catch (const FileError&) {
    return std::nullopt;
  }
}

void save_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                     const FilmAccumulator& film, const TileProgress& tiles) {
  Header header{.key = key,
                .tiles = tiles.samples.size(),
                .film_bytes = film.bytes().size(),
                .from = tiles.from,
                .noise = static_cast<double>(tiles.noise),
                .light = tiles.light};
  header.checksum = checksum(header, tiles, film);
  write_file_parts(file, [&](const WritePart& write) {
    write(std::as_bytes(std::span(&header, 1)));
    write(std::as_bytes(std::span(tiles.samples)));
    write(std::as_bytes(std::span(tiles.is_quiet)));
    write(film.bytes());
  });
}

std::optional<TileProgress> load_checkpoint(const std::filesystem::path& file, std::uint64_t key,
                                            FilmAccumulator& film) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const FileParts parts(file);
  Header header;
  const auto magic = header.magic;
  if (parts.size() >= sizeof header) parts.read(0, std::as_writable_bytes(std::span(&header, 1)));
  if (parts.size() < sizeof header || header.magic != magic)
    throw FileError(file.string() + ": is not an unfinished image of this version");
  const auto refuse = [&](const std::string& why) {
    throw FileError(file.string() + ": " + why + "; remove it, or render without --resume");
  };
  constexpr std::size_t per_tile = sizeof(std::int32_t) + sizeof(std::uint8_t);
  const std::uint64_t body = parts.size() - sizeof header;
  const std::span<std::byte> pixels = std::as_writable_bytes(film.pixels());
  if (header.key != key)
    refuse("is an unfinished image of another scene, other settings or another version of lamina");
  if (header.tiles > body || header.film_bytes != pixels.size() ||
      body != header.tiles * per_tile + header.film_bytes)
    refuse("is damaged");
  TileProgress tiles{.from = static_cast<int>(header.from),
                     .samples = std::vector<std::int32_t>(header.tiles),
                     .is_quiet = std::vector<std::uint8_t>(header.tiles),
                     .noise = static_cast<float>(header.noise),
                     .light = header.light};
  const std::span<std::byte> samples = std::as_writable_bytes(std::span(tiles.samples));
  parts.read(sizeof header, samples);
  parts.read(sizeof header + samples.size(), std::as_writable_bytes(std::span(tiles.is_quiet)));
  parts.read(parts.size() - pixels.size(), pixels);
  if (header.checksum != checksum(header, tiles, film)) refuse("is damaged");
  return tiles;
}

}  // namespace lamina
