// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lamina/base/io/disk_cache.h"
#include "lamina/skin/patch/material_texels.h"
#include "lamina/solve/scattering/heterogeneous/surface_transport.h"

namespace lamina {

/// Layers at all texels in one band, and what they make of light.
struct BandLayers {
  BandTexels texels;
  MappedStack stack;
  StackTables tables;
};

enum class LitFrom { above, below };

/// @param maps     of numbers of the material
/// @param count    of texels
/// @param cache    of tables
/// @throws InvalidInput as mapped_stack
[[nodiscard]] std::vector<BandLayers> make_band_layers(const Material& material,
                                                       std::span<const NumberTexels> maps,
                                                       std::size_t count, LitFrom from,
                                                       OperatorTotals totals,
                                                       const std::optional<DiskCache>& cache);

/// Whether layers are the same from above and from below, wherever they are alike.
[[nodiscard]] bool is_symmetric(std::span<const BandLayers> bands);

/// The thickness of all layers where each is thickest [mm].
[[nodiscard]] float largest_thickness(std::span<const BandLayers> bands);

/// The layers of all bands on the cells of a graph, which must outlive them.
template <int N>
[[nodiscard]] SurfaceLayers<N> on_surface(std::span<const BandLayers> bands,
                                          const CellGraph& graph) {
  SurfaceLayers<N> layers = make_surface_layers<N>(graph);
  for (std::size_t b = 0; b < bands.size(); ++b)
    layers.add_band(static_cast<int>(b), bands[b].tables, bands[b].texels.layers,
                    bands[b].texels.absorbance);
  return layers;
}

}  // namespace lamina
