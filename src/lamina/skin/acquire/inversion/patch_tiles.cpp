// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/patch_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina {
namespace {

/// Copies a rectangle of one plane to another.
void copy(const Plane& from, int from_x, int from_y, const TexelRectangle& to_place, Plane& to) {
  for (int y = 0; y < to_place.height; ++y)
    std::copy_n(
        from.values.begin() + static_cast<std::ptrdiff_t>(from_y + y) * from.width + from_x,
        to_place.width,
        to.values.begin() + static_cast<std::ptrdiff_t>(to_place.y + y) * to.width + to_place.x);
}

/// Of the part that is inverted, that which is kept.
TexelRectangle kept_within(const PatchTile& tile) {
  return {tile.kept.x - tile.inverted.x, tile.kept.y - tile.inverted.y, tile.kept.width,
          tile.kept.height};
}

/// What a tile has that is not inverted: the start, or the reference skin everywhere.
InversionResult maps_without_inversion(const InversionTables& tables, const PatchTile& tile,
                                       const InversionOptions& options) {
  InversionResult result;
  for (std::size_t n = 0; n < tables.numbers.size(); ++n) {
    const FitParameter& parameter = tables.numbers[n].parameter;
    const auto reference = static_cast<float>(fit_value(parameter, tables.reference[n]));
    result.numbers.push_back(
        {.name = parameter.name,
         .value = options.start.empty() ? make_plane(tile.kept.width, tile.kept.height, reference)
                                        : part_of(options.start[n], kept_within(tile))});
  }
  return result;
}

/// Whether a tile behind the first is for this machine: number `i` of so many.
bool is_wanted(const std::optional<KeptTiles>& kept, std::size_t i, std::size_t count) {
  if (!kept) return true;
  if (kept->only_first) return false;
  if (!kept->shard) return true;
  const IndexRange range = range_of(*kept->shard, static_cast<std::int64_t>(count));
  return range.begin <= static_cast<std::int64_t>(i) && static_cast<std::int64_t>(i) < range.end;
}

}  // namespace

int side_of_tiles(double bytes, std::size_t fields, double mm_per_texel, double halo) {
  constexpr double least = 64.0, most = 4096.0;
  const double inverted =
      std::sqrt(bytes / (inversion_bytes_per_texel * static_cast<double>(fields)));
  return static_cast<int>(std::clamp(inverted - 2.0 * std::ceil(halo / mm_per_texel), least, most));
}

std::vector<PatchTile> patch_tiles(int all_width, int all_height, double mm_per_texel,
                                   const TileOptions& options) {
  if (options.side <= 0)
    throw InvalidInput("side of tiles: must be > 0, but is " + std::to_string(options.side));
  if (!(std::isfinite(options.halo) && options.halo >= 0.0))
    throw InvalidInput("halo of tiles: must be >= 0 [mm], but is " + number_text(options.halo));
  const int halo = static_cast<int>(
      std::min<double>(std::ceil(options.halo / mm_per_texel), std::max(all_width, all_height)));
  const auto widened = [&](int at, int count, int all) {
    const int begin = std::max(0, at - halo);
    return std::pair(begin, std::min(all, at + count + halo) - begin);
  };
  std::vector<PatchTile> tiles;
  for (int y = 0; y < all_height; y += options.side)
    for (int x = 0; x < all_width; x += options.side) {
      const TexelRectangle kept{x, y, std::min(options.side, all_width - x),
                                std::min(options.side, all_height - y)};
      const auto [left, width] = widened(x, kept.width, all_width);
      const auto [top, height] = widened(y, kept.height, all_height);
      tiles.push_back({kept, {left, top, width, height}});
    }
  return tiles;
}

Plane part_of(const Plane& plane, const TexelRectangle& part) {
  Plane result = make_plane(part.width, part.height);
  copy(plane, part.x, part.y, {0, 0, part.width, part.height}, result);
  return result;
}

PatchCapture part_of(const PatchCapture& capture, const TexelRectangle& part) {
  PatchCapture result{.width = part.width,
                      .height = part.height,
                      .mm_per_texel = capture.mm_per_texel,
                      .theta = capture.theta,
                      .wavelengths = capture.wavelengths};
  for (const Plane& light : capture.lights) result.lights.push_back(part_of(light, part));
  for (const PatchImage& image : capture.images)
    result.images.push_back({.reflected = part_of(image.reflected, part),
                             .deviation = part_of(image.deviation, part),
                             .sensor = image.sensor,
                             .light = image.light});
  return result;
}

InversionResult invert_tile(const PatchCapture& capture, const InversionTables& tables,
                            const PatchTile& tile, const InversionOptions& options,
                            const Progress& progress) {
  if (check_part(capture, tile.inverted.x, tile.inverted.y) == 0)
    return maps_without_inversion(tables, tile, options);
  InversionResult result = invert_patch(capture, tables, options, progress);
  const TexelRectangle inner = kept_within(tile);
  for (NumberMap& map : result.numbers) {
    map.value = part_of(map.value, inner);
    if (map.deviation.values.empty()) continue;
    map.deviation = part_of(map.deviation, inner);
    map.prior_share = part_of(map.prior_share, inner);
  }
  for (Plane& residual : result.residual) residual = part_of(residual, inner);
  return result;
}

void put_tile(int width, int height, const PatchTile& tile, const InversionResult& part,
              InversionResult& whole) {
  const auto put = [&](const Plane& from, Plane& to, float unknown) {
    if (from.values.empty() && to.values.empty()) return;
    if (to.values.empty()) to = make_plane(width, height, unknown);
    if (!from.values.empty()) copy(from, 0, 0, tile.kept, to);
  };
  whole.numbers.resize(part.numbers.size());
  for (std::size_t n = 0; n < part.numbers.size(); ++n) {
    const NumberMap& from = part.numbers[n];
    NumberMap& to = whole.numbers[n];
    to.name = from.name;
    put(from.value, to.value, 0.0f);
    put(from.deviation, to.deviation, static_cast<float>(wide_deviation));
    put(from.prior_share, to.prior_share, 1.0f);
  }
  whole.residual.resize(std::max(whole.residual.size(), part.residual.size()));
  for (std::size_t i = 0; i < part.residual.size(); ++i)
    put(part.residual[i], whole.residual[i], 0.0f);
}

InversionResult invert_tiles(
    const LargePatch& patch, const InversionTables& tables, const TileOptions& tiling,
    const InversionOptions& options,
    const std::function<void(const PatchTile&, const InversionResult&)>& take,
    const Progress& progress) {
  std::vector<PatchTile> tiles = patch_tiles(patch.width, patch.height, patch.mm_per_texel, tiling);
  std::size_t most_known = 0, first = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const TexelRectangle& at = tiles[i].inverted;
    const std::size_t known = check_part(patch.part(at), at.x, at.y);
    if (known > most_known) {
      most_known = known;
      first = i;
    }
  }
  if (most_known == 0) throw InvalidInput("capture: must have a texel that is lit and known");
  std::swap(tiles[0], tiles[first]);
  InversionResult whole;
  InversionOptions own = options;
  bool is_interrupted = false;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const PatchTile& tile = tiles[i];
    const auto count = static_cast<double>(tiles.size());
    const auto done = static_cast<double>(i);
    if (i > 0 && !is_wanted(tiling.kept, i - 1, tiles.size() - 1)) continue;
    std::optional<InversionResult> kept;
    if (tiling.kept) kept = load_tile(*tiling.kept, tile.kept);
    if (!kept && patch.start) own.start = patch.start(tile.inverted);
    InversionResult part =
        kept ? std::move(*kept)
        : is_interrupted
            ? maps_without_inversion(tables, tile, own)
            : invert_tile(patch.part(tile.inverted), tables, tile, own,
                          lamina::part_of(progress, done / count, (done + 1.0) / count));
    is_interrupted |= part.stop == InversionStop::interrupted;
    if (tiling.kept && !kept && !is_interrupted) save_tile(*tiling.kept, tile.kept, part);
    take(tile, part);
    add_misfit(whole.misfit, part.misfit);
    if (i > 0) continue;
    own.smoothness = whole.smoothness = std::move(part.smoothness);
    own.error_growth = whole.error_growth = std::move(part.error_growth);
    whole.history = std::move(part.history);
    whole.correlation = std::move(part.correlation);
    whole.deviation_forwards = part.deviation_forwards;
    whole.stop = part.stop;
  }
  if (is_interrupted) whole.stop = InversionStop::interrupted;
  return whole;
}

InversionResult invert_tiles(const PatchCapture& capture, const InversionTables& tables,
                             const TileOptions& tiling, const InversionOptions& options,
                             const Progress& progress) {
  InversionOptions own = options;
  LargePatch patch{.width = capture.width,
                   .height = capture.height,
                   .mm_per_texel = capture.mm_per_texel,
                   .part = [&](const TexelRectangle& part) { return part_of(capture, part); }};
  if (!options.start.empty())
    patch.start = [&](const TexelRectangle& part) {
      std::vector<Plane> planes;
      for (const Plane& start : options.start) planes.push_back(part_of(start, part));
      return planes;
    };
  own.start.clear();
  InversionResult maps;
  InversionResult whole = invert_tiles(
      patch, tables, tiling, own,
      [&](const PatchTile& tile, const InversionResult& part) {
        put_tile(capture.width, capture.height, tile, part, maps);
      },
      progress);
  whole.numbers = std::move(maps.numbers);
  whole.residual = std::move(maps.residual);
  return whole;
}

}  // namespace lamina
