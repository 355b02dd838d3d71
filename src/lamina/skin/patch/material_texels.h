// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/heterogeneous/tables/gaussian_tables.h"

namespace lamina {

/// A number of a material at each texel of a surface.
struct NumberTexels {
  MappableNumber number;
  std::size_t channels = 1;   ///< one, or one for each band
  std::vector<float> values;  ///< [texel][channel]
};

/// Material at each texel in one band.
struct BandTexels {
  std::vector<LayerTexels> layers;
  /// [layer - 1] natural absorbance of the sheet above a layer, per crossing; a number for each
  /// texel, or one
  std::vector<std::vector<float>> absorbance;
};

/// Texels lit from below.
[[nodiscard]] inline BandTexels flipped(BandTexels texels) {
  std::ranges::reverse(texels.layers);
  std::ranges::reverse(texels.absorbance);
  return texels;
}

/// Whether light leaves below: the layers are finite and lie on no ground.
[[nodiscard]] inline bool lets_light_through(const Material& material) {
  return std::isfinite(material.layers.back().thickness) && material.ground.reflectance == 0.0;
}

/// Layers of a material, texel by texel: of skin epidermis and dermis and the sheet between them,
/// of a leaf its two layers, of all others those that the material has. Mixtures add up by volume,
/// as in layer_stack; fractions that ask for more than all of it are scaled down to it. Phase
/// functions count by their mean cosine.
///
/// @param maps  replace what the material says
/// @param band  less than material.bands.size()
[[nodiscard]] BandTexels band_texels(const Material& material, std::span<const NumberTexels> maps,
                                     std::size_t texels, std::size_t band);

/// The stack for tables of a band: of layers of which only absorption varies, within the range of
/// the grid, that of all absorptions, which many maps share; of others that of their states.
/// @throws InvalidInput where a boundary inside is rough
[[nodiscard]] MappedStack mapped_stack(const Material& material, std::size_t band,
                                       const BandTexels& texels,
                                       const GaussianTableGrid& grid = {});

/// Absorption of each layer that tables take while others vary.
[[nodiscard]] std::vector<double> reference_absorptions(const BandTexels& texels);

/// The mean natural absorbance of each sheet, [layer - 1].
[[nodiscard]] std::vector<double> typical_absorbances(const BandTexels& texels);

/// The geometric mean of absorptions. Where they differ it is rounded to a fourth of a natural
/// logarithm, so that similar maps share their tables.
[[nodiscard]] double typical_absorption(std::span<const float> sigma_a);

}  // namespace lamina
