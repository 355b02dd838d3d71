// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/texture_space/internal/band_layers.h"

#include <algorithm>
#include <utility>

#include "lamina/base/core/parallel.h"

namespace lamina {

std::vector<BandLayers> make_band_layers(const Material& material,
                                         std::span<const NumberTexels> maps, std::size_t count,
                                         LitFrom from, OperatorTotals totals,
                                         const std::optional<DiskCache>& cache) {
  std::vector<BandLayers> bands(material.bands.size());
  parallel_for(bands.size(), [&](std::size_t b) {
    BandLayers& band = bands[b];
    band.texels = band_texels(material, maps, count, b);
    band.stack = mapped_stack(material, b, band.texels);
    if (from == LitFrom::below) {
      band.texels = flipped(std::move(band.texels));
      band.stack = flipped(std::move(band.stack));
    }
    band.tables =
        cached_stack_tables(cache, band.stack, totals, reference_absorptions(band.texels));
  });
  return bands;
}

bool is_symmetric(std::span<const BandLayers> bands) {
  return std::ranges::all_of(bands, [](const BandLayers& band) {
    return band.stack.layers.size() == 1 && band.stack.ior_above == band.stack.ior_below;
  });
}

float largest_thickness(std::span<const BandLayers> bands) {
  float largest = 0.0f;
  for (const BandLayers& band : bands) {
    float all = 0.0f;
    for (const LayerTexels& layer : band.texels.layers) all += std::ranges::max(layer.thickness);
    largest = std::max(largest, all);
  }
  return largest;
}

}  // namespace lamina
