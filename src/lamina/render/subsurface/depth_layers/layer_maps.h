// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/layers/materials/material.h"
#include "lamina/render/subsurface/depth_layers/depth_layers.h"
#include "lamina/skin/maps/material_maps.h"

namespace lamina {

/// The layers of a material, those without a thickness that counts apart.
struct SheetedLayers {
  Material whole;   ///< as it was
  Material layers;  ///< without sheets
  /// [layer][band] absorption of the sheet above a layer: the optical thickness along the normal
  std::vector<std::vector<double>> sheets;
};
/// The junction of skin, a layer of a micrometre, as a sheet that absorbs.
[[nodiscard]] SheetedLayers with_sheets(Material material);

/// Layers of a material at each texel of its maps, in all bands; without maps there is
/// one texel. Between texels all is bilinear.
template <int N>
struct LayerMaps {
  using Bands = BandValues<N>;
  struct Layer {
    std::vector<Bands> sigma_s, sigma_t;  ///< [texel] or one for all [1/mm]
    std::vector<Bands> g;      ///< [texel] of Henyey and Greenstein; empty: the layer's own
    std::vector<Bands> sheet;  ///< [texel] or one: optical thickness of the sheet above it
    Bands most_extinction, least_extinction;  ///< [1/mm]

    [[nodiscard]] bool is_mapped() const { return sigma_t.size() > 1 || !g.empty(); }
    [[nodiscard]] bool has_sheet() const { return !sheet.empty(); }
  };
  DepthLayers::Thickness thickness;  ///< and the texels of all
  std::vector<Layer> layers;

  [[nodiscard]] bool is_mapped() const { return thickness.grid.count() > 1; }
};

/// @param maps  replace what the layers say, as band_texels takes them. Those of more texels than
///              fit into 512 MB are resampled.
template <int N>
[[nodiscard]] LayerMaps<N> make_layer_maps(const SheetedLayers& inside,
                                           std::span<const MaterialMap> maps);

}  // namespace lamina
