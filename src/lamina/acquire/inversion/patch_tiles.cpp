// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/acquire/inversion/patch_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/core/number_text.h"

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

Plane cut(const Plane& plane, const TexelRectangle& part) {
  Plane result = make_plane(part.width, part.height);
  copy(plane, part.x, part.y, {0, 0, part.width, part.height}, result);
  return result;
}

std::size_t known_texels(const PatchCapture& capture, const TexelRectangle& part) {
  std::size_t count = 0;
  for (const PatchImage& image : capture.images)
    for (int y = part.y; y < part.y + part.height; ++y)
      for (int x = part.x; x < part.x + part.width; ++x) {
        const auto t = static_cast<std::size_t>(y) * static_cast<std::size_t>(capture.width) +
                       static_cast<std::size_t>(x);
        count +=
            !std::isinf(image.deviation.values[t]) && capture.lights[image.light].values[t] > 0.0f;
      }
  return count;
}

/// The reference skin everywhere.
InversionResult reference_maps(const PatchCapture& capture, const InversionTables& tables,
                               const TexelRectangle& size) {
  InversionResult result;
  for (std::size_t n = 0; n < tables.numbers.size(); ++n) {
    const FitParameter& parameter = tables.numbers[n].parameter;
    result.numbers.push_back(
        {.name = parameter.name,
         .value = make_plane(size.width, size.height,
                             static_cast<float>(fit_value(parameter, tables.reference[n])))});
  }
  result.residual.assign(capture.images.size(), make_plane(size.width, size.height));
  return result;
}

}  // namespace

std::vector<PatchTile> patch_tiles(const PatchCapture& capture, const TileOptions& options) {
  if (options.side <= 0)
    throw InvalidInput("side of tiles: must be > 0, but is " + std::to_string(options.side));
  if (!(std::isfinite(options.halo) && options.halo >= 0.0))
    throw InvalidInput("halo of tiles: must be >= 0 [mm], but is " + number_text(options.halo));
  const double texels = std::ceil(options.halo / capture.mm_per_texel);
  const int halo =
      static_cast<int>(std::min<double>(texels, std::max(capture.width, capture.height)));
  const auto widened = [&](int at, int count, int all) {
    const int begin = std::max(0, at - halo);
    return std::pair(begin, std::min(all, at + count + halo) - begin);
  };
  std::vector<PatchTile> tiles;
  for (int y = 0; y < capture.height; y += options.side)
    for (int x = 0; x < capture.width; x += options.side) {
      const TexelRectangle kept{x, y, std::min(options.side, capture.width - x),
                                std::min(options.side, capture.height - y)};
      const auto [left, width] = widened(x, kept.width, capture.width);
      const auto [top, height] = widened(y, kept.height, capture.height);
      tiles.push_back({kept, {left, top, width, height}});
    }
  return tiles;
}

PatchCapture part_of(const PatchCapture& capture, const TexelRectangle& part) {
  PatchCapture result{.width = part.width,
                      .height = part.height,
                      .mm_per_texel = capture.mm_per_texel,
                      .theta = capture.theta,
                      .wavelengths = capture.wavelengths};
  for (const Plane& light : capture.lights) result.lights.push_back(cut(light, part));
  for (const PatchImage& image : capture.images)
    result.images.push_back({.reflected = cut(image.reflected, part),
                             .deviation = cut(image.deviation, part),
                             .sensor = image.sensor,
                             .light = image.light});
  return result;
}

InversionResult invert_tile(const PatchCapture& capture, const InversionTables& tables,
                            const PatchTile& tile, const InversionOptions& options,
                            const Progress& progress) {
  if (known_texels(capture, tile.inverted) == 0) return reference_maps(capture, tables, tile.kept);
  InversionOptions own = options;
  for (Plane& start : own.start) start = cut(start, tile.inverted);
  InversionResult result = invert_patch(part_of(capture, tile.inverted), tables, own, progress);
  const TexelRectangle inner{tile.kept.x - tile.inverted.x, tile.kept.y - tile.inverted.y,
                             tile.kept.width, tile.kept.height};
  for (NumberMap& map : result.numbers) {
    map.value = cut(map.value, inner);
    if (map.deviation.values.empty()) continue;
    map.deviation = cut(map.deviation, inner);
    map.prior_share = cut(map.prior_share, inner);
  }
  for (Plane& residual : result.residual) residual = cut(residual, inner);
  return result;
}

void put_tile(const PatchCapture& capture, const PatchTile& tile, const InversionResult& part,
              InversionResult& whole) {
  const auto put = [&](const Plane& from, Plane& to, float unknown) {
    if (from.values.empty() && to.values.empty()) return;
    if (to.values.empty()) to = make_plane(capture.width, capture.height, unknown);
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
  whole.residual.resize(part.residual.size());
  for (std::size_t i = 0; i < part.residual.size(); ++i)
    put(part.residual[i], whole.residual[i], 0.0f);
}

InversionResult invert_tiles(const PatchCapture& capture, const InversionTables& tables,
                             const TileOptions& tiling, const InversionOptions& options,
                             const Progress& progress) {
  check_capture(capture);
  std::vector<PatchTile> tiles = patch_tiles(capture, tiling);
  const auto best = std::ranges::max_element(
      tiles, {}, [&](const PatchTile& tile) { return known_texels(capture, tile.inverted); });
  std::iter_swap(tiles.begin(), best);
  InversionResult whole;
  InversionOptions own = options;
  bool is_interrupted = false;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto count = static_cast<double>(tiles.size());
    InversionResult part =
        is_interrupted ? reference_maps(capture, tables, tiles[i].kept)
                       : invert_tile(capture, tables, tiles[i], own,
                                     lamina::part_of(progress, static_cast<double>(i) / count,
                                                     static_cast<double>(i + 1) / count));
    is_interrupted |= part.stop == InversionStop::interrupted;
    put_tile(capture, tiles[i], part, whole);
    if (i > 0) continue;
    own.smoothness = whole.smoothness = std::move(part.smoothness);
    whole.history = std::move(part.history);
    whole.correlation = std::move(part.correlation);
    whole.deviation_forwards = part.deviation_forwards;
    whole.stop = part.stop;
  }
  if (is_interrupted) whole.stop = InversionStop::interrupted;
  return whole;
}

}  // namespace lamina
