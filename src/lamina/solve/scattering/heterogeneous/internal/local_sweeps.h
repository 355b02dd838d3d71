// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "lamina/solve/scattering/heterogeneous/internal/interlayer_series.h"

// What all further sweeps between layers make of light at one place, as if all places were like it.
// Numbers are doubles, or vectors of bands.

namespace lamina::detail {

inline constexpr std::size_t most_junctions = 7;

template <class T>
using Sweep = std::array<std::array<T, most_junctions>, most_junctions>;

/// Result of one sweep up and down for light that goes down at n junctions; [to][from].
///
/// @param total     (layer, operator) -> its total
/// @param junction  (j) -> what a crossing leaves
template <class T, class Total, class Junction>
[[nodiscard]] Sweep<T> local_sweep(std::size_t n, const Total& total, const Junction& junction) {
  Sweep<T> sweep{};
  for (std::size_t from = 0; from < n; ++from) {
    std::array<T, most_junctions> up{}, down{};
    for (std::size_t j = n; j-- > 0;) {
      if (j == from) up[j] = total(j + 1, reflection_above);
      if (j + 1 < n) up[j] = up[j] + total(j + 1, transmission_up) * up[j + 1];
      up[j] = up[j] * junction(j);
    }
    for (std::size_t j = 0; j < n; ++j) {
      down[j] = total(j, reflection_below) * up[j];
      if (j > 0) down[j] = down[j] + total(j, transmission_down) * down[j - 1];
      down[j] = down[j] * junction(j);
      sweep[j][from] = down[j];
    }
  }
  return sweep;
}

/// Solves (1 - sweep) x = light by Gauss's elimination; no pivots are needed, since no sweep gains
/// energy.
///
/// @param one  of the numbers
template <class T>
[[nodiscard]] std::array<T, most_junctions> sum_of_sweeps(Sweep<T> sweep, std::size_t n,
                                                          const T& one,
                                                          std::array<T, most_junctions> light) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) sweep[i][j] = (i == j ? one : T{}) - sweep[i][j];
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t i = p + 1; i < n; ++i) {
      const T share = sweep[i][p] / sweep[p][p];
      for (std::size_t j = p; j < n; ++j) sweep[i][j] = sweep[i][j] - share * sweep[p][j];
      light[i] = light[i] - share * light[p];
    }
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t j = p + 1; j < n; ++j) light[p] = light[p] - sweep[p][j] * light[j];
    light[p] = light[p] / sweep[p][p];
  }
  return light;
}

/// Where more than this part of the light that goes down through an only junction comes down again,
/// it is returned by what is around the place rather than by what is there.
inline constexpr float most_local_return = 0.5f;

}  // namespace lamina::detail
