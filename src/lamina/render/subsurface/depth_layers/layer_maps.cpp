// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/depth_layers/layer_maps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/base/image/resample.h"
#include "lamina/skin/patch/material_texels.h"

namespace lamina {
namespace {

constexpr double most_bytes = 512e6;
/// Light that diffuses crosses a sheet at 60 degrees in the mean: what absorbance per crossing
/// makes of a sheet's optical thickness, as in skin_layer_stack.
constexpr float mean_cosine_of_crossing = 0.5f;

TexelGrid grid_of(std::span<const MaterialMap> maps, double bytes_of_texel) {
  TexelGrid grid;
  for (const MaterialMap& map : maps) {
    grid.width = std::max(grid.width, map.values.width);
    grid.height = std::max(grid.height, map.values.height);
  }
  const double bytes = bytes_of_texel * static_cast<double>(grid.count());
  if (bytes > most_bytes) {
    const double smaller = std::sqrt(most_bytes / bytes);
    grid.width = std::max(1, static_cast<int>(smaller * grid.width));
    grid.height = std::max(1, static_cast<int>(smaller * grid.height));
  }
  return grid;
}

std::vector<NumberTexels> on_grid(std::span<const MaterialMap> maps, const TexelGrid& grid) {
  std::vector<NumberTexels> texels;
  for (const MaterialMap& map : maps) {
    const bool fits = map.values.width == grid.width && map.values.height == grid.height;
    texels.push_back(
        {map.number, map.values.channel_count(),
         fits ? map.values.pixels : resampled(map.values, grid.width, grid.height).pixels});
  }
  return texels;
}

/// What is but there for logarithms is nothing.
float coefficient(float value) {
  return static_cast<double>(value) <= 1.01 * least_coefficient ? 0.0f : value;
}

/// The values of all bands side by side: one for all texels, if all bands have one.
///
/// @param of_band  the values of a band
template <int N, class OfBand>
std::vector<BandValues<N>> side_by_side(const std::vector<BandTexels>& bands,
                                        const OfBand& of_band) {
  std::size_t size = 1;
  for (const BandTexels& band : bands) size = std::max(size, of_band(band).size());
  std::vector<BandValues<N>> values(size);
  for (std::size_t b = 0; b < static_cast<std::size_t>(N); ++b) {
    // Lanes beyond the bands repeat the last.
    const std::vector<float>& from = of_band(bands[std::min(b, bands.size() - 1)]);
    for (std::size_t i = 0; i < size; ++i)
      values[i][static_cast<int>(b)] = from[from.size() > 1 ? i : 0];
  }
  return values;
}

template <int N>
typename LayerMaps<N>::Layer make_layer(const std::vector<BandTexels>& bands, std::size_t l) {
  typename LayerMaps<N>::Layer layer;
  layer.sigma_s =
      side_by_side<N>(bands, [&](const BandTexels& band) { return band.layers[l].sigma_s; });
  layer.sigma_t =
      side_by_side<N>(bands, [&](const BandTexels& band) { return band.layers[l].sigma_a; });
  for (BandValues<N>& values : layer.sigma_s)
    for (float& value : values.v) value = coefficient(value);
  for (BandValues<N>& values : layer.sigma_t)
    for (float& value : values.v) value = coefficient(value);
  if (layer.sigma_t.size() < layer.sigma_s.size())
    layer.sigma_t.resize(layer.sigma_s.size(), layer.sigma_t[0]);
  for (std::size_t i = 0; i < layer.sigma_t.size(); ++i)
    layer.sigma_t[i] += layer.sigma_s[layer.sigma_s.size() > 1 ? i : 0];
  layer.g = side_by_side<N>(bands, [&](const BandTexels& band) { return band.layers[l].g; });
  if (layer.g.size() == 1) layer.g.clear();
  layer.most_extinction = layer.least_extinction = layer.sigma_t[0];
  for (const BandValues<N>& values : layer.sigma_t) {
    layer.most_extinction = max(layer.most_extinction, values);
    layer.least_extinction = min(layer.least_extinction, values);
  }
  return layer;
}

}  // namespace

SheetedLayers with_sheets(Material material) {
  SheetedLayers result{.whole = material, .layers = {}, .sheets = {}};
  const std::size_t bands = material.bands.size();
  if (material.skin && material.layers.size() == 3) {
    MaterialLayer& epidermis = material.layers[0];
    const MaterialLayer& junction = material.layers[1];
    std::vector<double> sheet;
    for (std::size_t b = 0; b < bands; ++b)
      sheet.push_back(std::max(junction.sigma_a[b] - epidermis.sigma_a[b], 0.0) *
                      junction.thickness);
    epidermis.thickness += junction.thickness;
    material.layers.erase(material.layers.begin() + 1);
    result.sheets = {{}, std::move(sheet)};
  }
  result.sheets.resize(material.layers.size());
  result.layers = std::move(material);
  return result;
}

template <int N>
LayerMaps<N> make_layer_maps(const SheetedLayers& inside, std::span<const MaterialMap> maps) {
  Material material = inside.layers;
  // Without maps the layers say all.
  if (maps.empty()) material.skin.reset(), material.leaf.reset();
  const std::size_t count = material.layers.size();
  LayerMaps<N> result;
  TexelGrid& grid = result.thickness.grid;
  grid = grid_of(maps, static_cast<double>(2 * sizeof(BandValues<N>) * count));
  const std::vector<NumberTexels> numbers = on_grid(maps, grid);
  std::vector<BandTexels> bands(material.bands.size());
  parallel_for(bands.size(),
               [&](std::size_t b) { bands[b] = band_texels(material, numbers, grid.count(), b); });
  for (std::size_t l = 0; l < count; ++l) {
    result.layers.push_back(make_layer<N>(bands, l));
    typename LayerMaps<N>::Layer& layer = result.layers.back();
    if (l + 1 < count) result.thickness.layers.push_back(bands[0].layers[l].thickness);
    if (l == 0) continue;
    if (!maps.empty()) {
      layer.sheet =
          side_by_side<N>(bands, [&](const BandTexels& band) { return band.absorbance[l - 1]; });
      for (BandValues<N>& values : layer.sheet) values *= mean_cosine_of_crossing;
    } else if (!inside.sheets[l].empty()) {
      layer.sheet.resize(1);
      for (int b = 0; b < N; ++b)
        layer.sheet[0][b] = static_cast<float>(
            inside.sheets[l][std::min(static_cast<std::size_t>(b), bands.size() - 1)]);
    }
    const bool absorbs = std::ranges::any_of(
        layer.sheet, [](const BandValues<N>& values) { return largest(values) > 0.0f; });
    if (!absorbs) layer.sheet.clear();
  }
  result.thickness.has_maps_below = result.layers.back().is_mapped();
  return result;
}

template LayerMaps<4> make_layer_maps(const SheetedLayers&, std::span<const MaterialMap>);
template LayerMaps<8> make_layer_maps(const SheetedLayers&, std::span<const MaterialMap>);
template LayerMaps<16> make_layer_maps(const SheetedLayers&, std::span<const MaterialMap>);

}  // namespace lamina
