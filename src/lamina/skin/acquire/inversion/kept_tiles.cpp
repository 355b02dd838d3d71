// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/kept_tiles.h"

#include <limits>
#include <string>

#include "lamina/base/core/error.h"
#include "lamina/base/io/disk_cache.h"
#include "lamina/base/io/packed_values.h"

// Structures are taken apart by structured bindings: a new member does not compile until it is
// written here, too.
namespace lamina {
namespace {

DiskCache cache_of(const KeptTiles& tiles) {
  return {.folder = tiles.folder, .most_bytes = std::numeric_limits<std::uintmax_t>::max()};
}

std::string key_of(const KeptTiles& tiles, const TexelRectangle& kept) {
  PackedWriter writer;
  writer.put_text("tile, format 2");
  const auto& [x, y, width, height] = kept;
  writer.put(tiles.key);
  for (const int value : {x, y, width, height}) writer.put(value);
  return std::move(writer).bytes();
}

void put(PackedWriter& writer, const Plane& plane) {
  const auto& [width, height, values] = plane;
  writer.put(width);
  writer.put(height);
  writer.put(values);
}

void get(PackedReader& reader, Plane& plane) {
  auto& [width, height, values] = plane;
  reader.get(width);
  reader.get(height);
  reader.get(values);
}

std::string packed(const InversionResult& result) {
  const auto& [numbers, correlation, residual, smoothness, history, misfit, error_growth,
               deviation_forwards, stop] = result;
  PackedWriter writer;
  writer.put(numbers.size());
  for (const auto& [name, value, deviation, prior_share] : numbers) {
    writer.put_text(name);
    for (const Plane* plane : {&value, &deviation, &prior_share}) put(writer, *plane);
  }
  writer.put(correlation.rows);
  writer.put(correlation.columns);
  writer.put(correlation.values);
  writer.put(residual.size());
  for (const Plane& plane : residual) put(writer, plane);
  writer.put(smoothness);
  writer.put(history.size());
  for (const auto& [forwards, of_mean, in_deviations, objective] : history)
    for (const double value : {forwards, of_mean, in_deviations, objective}) writer.put(value);
  writer.put(misfit.size());
  for (const auto& [squares, left, count] : misfit)
    for (const double value : {squares, left, count}) writer.put(value);
  writer.put(error_growth);
  writer.put(deviation_forwards);
  writer.put(stop);
  return std::move(writer).bytes();
}

/// Of a checksum that holds: sizes are as they were written.
std::optional<InversionResult> unpacked(std::string_view bytes) {
  InversionResult result;
  auto& [numbers, correlation, residual, smoothness, history, misfit, error_growth,
         deviation_forwards, stop] = result;
  PackedReader reader(bytes);
  std::size_t size = 0;
  const auto get_size = [&] {
    size = 0;
    reader.get(size);
    return size <= bytes.size() ? size : 0;
  };
  numbers.resize(get_size());
  for (auto& [name, value, deviation, prior_share] : numbers) {
    reader.get_text(name);
    for (Plane* plane : {&value, &deviation, &prior_share}) get(reader, *plane);
  }
  reader.get(correlation.rows);
  reader.get(correlation.columns);
  reader.get(correlation.values);
  residual.resize(get_size());
  for (Plane& plane : residual) get(reader, plane);
  reader.get(smoothness);
  history.resize(get_size());
  for (auto& [forwards, of_mean, in_deviations, objective] : history)
    for (double* value : {&forwards, &of_mean, &in_deviations, &objective}) reader.get(*value);
  misfit.resize(get_size());
  for (auto& [squares, left, count] : misfit)
    for (double* value : {&squares, &left, &count}) reader.get(*value);
  reader.get(error_growth);
  reader.get(deviation_forwards);
  reader.get(stop);
  return reader.is_done() ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace

std::optional<InversionResult> load_tile(const KeptTiles& tiles, const TexelRectangle& kept) {
  const std::optional<std::string> bytes = load_cached(cache_of(tiles), key_of(tiles, kept));
  return bytes ? unpacked(*bytes) : std::nullopt;
}

void save_tile(const KeptTiles& tiles, const TexelRectangle& kept, const InversionResult& result) {
  if (!save_cached(cache_of(tiles), key_of(tiles, kept), packed(result)))
    throw WriteError(tiles.folder.string() + ": the maps of a tile cannot be written");
}

}  // namespace lamina
