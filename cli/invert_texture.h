// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "lamina/base/core/memory_budget.h"
#include "lamina/base/core/progress.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/solve/albedo_inversion/half_space_color.h"

namespace lamina::cli {

/// Settings of the inversion of a texture's texels.
struct TextureInversion {
  std::string file;
  ColorEncoding encoding = ColorEncoding::srgb;
  bool takes_nearest = false;                        ///< of a color that is not reached
  std::optional<std::array<double, 3>> radius = {};  ///< [mm]; then coefficients are wanted, too
  RadiusMeaning meaning = RadiusMeaning::mean_free_path;
};

/// R, G and B are the albedos; sigma_a.R and so on follow if wanted; A is that of the texture.
struct InvertedTexture {
  Image image;
  std::size_t clamped = 0;  ///< texels with a channel that took the nearest color
};

/// @throws FileError if the texture cannot be read; InvalidInput naming the first texel whose color
///         is not reached and how many there are; Interrupted if progress asks to stop.
[[nodiscard]] InvertedTexture invert_texture(const TextureInversion& wanted,
                                             const HalfSpaceLook& look, MemoryBudget memory,
                                             const Progress& progress);

}  // namespace lamina::cli
