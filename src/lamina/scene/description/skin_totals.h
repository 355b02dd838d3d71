// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lamina/scene/description/scene.h"

// The constants of skin belong to the totals that they were fitted with: "calibrated" to those of
// radiative transfer. So whatever method spreads the light of such skin, and by whatever profile,
// what it reflects and lets through in all is that of radiative transfer, and all show one color.

namespace lamina {

/// Whether a method that spreads light by diffusion takes the totals of radiative transfer: for
/// skin with constants made for them, unless light scattered once is added to what diffusion finds.
[[nodiscard]] bool takes_material_totals(const Material& material, const RenderSettings& settings);

/// How the method of a scene takes a material of skin.
struct SkinTotals {
  std::uint32_t material = 0;  ///< index
  SkinConstants constants = SkinConstants::calibrated;
  bool by_transfer = true;  ///< totals by radiative transfer, else by diffusion
};

/// Totals of all translucent materials made by the recipe.
[[nodiscard]] std::vector<SkinTotals> skin_totals(const Scene& scene);

/// Describes totals in a line, which warns of constants that were fitted with other totals.
[[nodiscard]] std::string describe_skin_totals(const SkinTotals& totals, const Scene& scene);

}  // namespace lamina
