// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/render/subsurface/irradiance_fireflies.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lamina/core/parallel.h"

namespace lamina {

template <int N>
void dim_specks(const CellLevel& cells, CellField<N>& light) {
  constexpr float most = 2.0f;  // of what the brightest neighbour has
  constexpr std::size_t chunk = 8192;
  std::vector<float> brightness(light.size());
  for (std::size_t i = 0; i < light.size(); ++i)
    for (int b = 0; b < N; ++b) brightness[i] += light[i][b];
  parallel_for((light.size() + chunk - 1) / chunk, [&](std::size_t c) {
    for (std::size_t i = c * chunk; i < std::min(light.size(), (c + 1) * chunk); ++i) {
      if (cells.first[i] == cells.first[i + 1]) continue;  // stands alone
      float around = 0.0f;
      for (std::uint32_t k = cells.first[i]; k < cells.first[i + 1]; ++k)
        around = std::max(around, brightness[cells.neighbors[k].cell]);
      if (brightness[i] > most * around) light[i] *= most * around / brightness[i];
    }
  });
}

template void dim_specks<4>(const CellLevel&, CellField<4>&);
template void dim_specks<8>(const CellLevel&, CellField<8>&);
template void dim_specks<16>(const CellLevel&, CellField<16>&);

}  // namespace lamina
