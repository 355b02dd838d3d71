// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lamina/base/io/json_output.h"
#include "lamina/base/spectrum/color.h"
#include "lamina/layers/materials/material.h"
#include "lamina/solve/scattering/profile/slab_totals.h"

namespace lamina::cli {

/// A color as a display shows it.
struct DisplayColor {
  LinearSrgb linear;          ///< may lie outside [0, 1]
  std::array<int, 3> srgb{};  ///< 8 bits each, cut off at 0 and 255
  bool is_cut_off = false;    ///< whether a channel lies outside [0, 1] by more than 8 bits tell
  [[nodiscard]] std::string hex() const;  ///< "#c08060"
};

[[nodiscard]] DisplayColor display_color(const LinearSrgb& linear);

/// Colors of a material in even white light (D65): the light that comes out of it, without
/// what the surface mirrors, and that which comes through, if any does.
struct SlabColors {
  DisplayColor reflected;
  std::optional<DisplayColor> transmitted;
};

/// @param totals  [band] of the material
/// @return        absent if its bands cannot tell colors apart
[[nodiscard]] std::optional<SlabColors> slab_colors(const Material& material,
                                                    const std::vector<SlabTotals>& totals);

[[nodiscard]] JsonOutput slab_colors_json(const SlabColors& colors);

/// A line for each color. @param has_chips  with a piece of the color behind it, by the escape
/// sequences of terminals that know 24 bits (ISO 8613-6)
[[nodiscard]] std::string slab_colors_text(const SlabColors& colors, bool has_chips);

}  // namespace lamina::cli
