// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina::reference {

/// [DonnerJensen2005] Table 3: human skin as three layers, [band] red, green, blue.
[[nodiscard]] inline std::vector<LayerStack> donner_jensen_skin() {
  constexpr std::array<double, 3> epidermis_a = {2.1, 2.1, 5.0}, epidermis_s = {48, 60, 65},
                                  upper_a = {.16, .19, .30}, upper_s = {32, 40, 46},
                                  bloody_a = {.085, 1.0, 25.0}, bloody_s = {4.5, 4.7, 4.8};
  std::vector<LayerStack> bands;
  for (std::size_t b = 0; b < 3; ++b)
    bands.emplace_back(
        std::vector<Layer>{{.medium = {epidermis_a[b], epidermis_s[b], 0.0, 1.4}, .thickness = .03},
                           {.medium = {upper_a[b], upper_s[b], .25, 1.34}, .thickness = .05},
                           {.medium = {bloody_a[b], bloody_s[b], .8, 1.4},
                            .thickness = std::numeric_limits<double>::infinity()}});
  return bands;
}

}  // namespace lamina::reference
