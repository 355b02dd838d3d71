// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/irradiance_fireflies.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/base/core/parallel_chunks.h"

namespace lamina {

template <int N>
void clamp_fireflies(const CellLevel& cells, CellField<N>& light) {
  constexpr float most = 2.0f;  // of what the brightest neighbour has
  constexpr std::size_t chunk = 8192;
  std::vector<float> brightness(light.size());
  for (std::size_t i = 0; i < light.size(); ++i)
    for (int b = 0; b < N; ++b) brightness[i] += light[i][b];
  parallel_chunks(light.size(), chunk, [&](std::size_t i) {
    if (cells.first[i] == cells.first[i + 1]) return;  // stands alone
    float around = 0.0f;
    for (std::uint32_t k = cells.first[i]; k < cells.first[i + 1]; ++k)
      around = std::max(around, brightness[cells.neighbors[k].cell]);
    if (brightness[i] > most * around) light[i] *= most * around / brightness[i];
  });
}

template void clamp_fireflies<4>(const CellLevel&, CellField<4>&);
template void clamp_fireflies<8>(const CellLevel&, CellField<8>&);
template void clamp_fireflies<16>(const CellLevel&, CellField<16>&);

}  // namespace lamina
