// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/solve/scattering/heterogeneous/internal/local_sweeps.h"

// One sweep of light between layers at one place, and derivatives brought back over it.

namespace lamina::detail {

template <class N>
using PerJunctionOf = std::array<N, most_junctions>;
using PerJunction = PerJunctionOf<double>;

/// Totals [layer][operator] and what crossings leave [junction] at one place; or derivatives by
/// them.
template <class N>
struct LocalLayersOf {
  explicit LocalLayersOf(std::size_t junctions) : n(junctions) {}
  std::size_t n;
  std::array<std::array<N, 4>, most_junctions + 1> total{};
  PerJunctionOf<N> junction{};
};
using LocalLayers = LocalLayersOf<double>;

template <class N>
[[nodiscard]] Sweep<N> sweep_of(const LocalLayersOf<N>& here) {
  return local_sweep<N>(
      here.n, [&](std::size_t layer, LayerOperator which) { return here.total[layer][which]; },
      [&](std::size_t j) { return here.junction[j]; });
}

/// Light that goes down at each junction, of light that goes up there.
template <class N>
[[nodiscard]] PerJunctionOf<N> light_down(const LocalLayersOf<N>& here,
                                          const PerJunctionOf<N>& up) {
  PerJunctionOf<N> down{};
  for (std::size_t j = 0; j < here.n; ++j) {
    down[j] = here.total[j][reflection_below] * up[j];
    if (j > 0) down[j] = down[j] + here.total[j][transmission_down] * down[j - 1];
    down[j] = down[j] * here.junction[j];
  }
  return down;
}

/// From derivatives by `down` = light_down(here, up) to those by `up`, returned, and by what is
/// here, added.
[[nodiscard]] inline PerJunction back_over_light_down(const LocalLayers& here,
                                                      const PerJunction& up,
                                                      const PerJunction& down, PerJunction by_down,
                                                      LocalLayers& by_here) {
  PerJunction by_up{};
  for (std::size_t j = here.n; j-- > 0;) {
    const std::array<double, 4>& total = here.total[j];
    const double passed = j > 0 ? down[j - 1] : 0.0;
    by_here.junction[j] +=
        by_down[j] * (total[reflection_below] * up[j] + total[transmission_down] * passed);
    const double by_sum = by_down[j] * here.junction[j];
    by_here.total[j][reflection_below] += by_sum * up[j];
    by_up[j] = by_sum * total[reflection_below];
    if (j == 0) continue;
    by_here.total[j][transmission_down] += by_sum * passed;
    by_down[j - 1] += by_sum * total[transmission_down];
  }
  return by_up;
}

/// From derivatives by the light that one sweep up and down brings to each junction, to those by
/// what is here, added.
///
/// @param light  that went down before the sweep
inline void back_over_sweep(const LocalLayers& here, const PerJunction& light,
                            const PerJunction& by_down, LocalLayers& by_here) {
  PerJunction up{};
  for (std::size_t j = here.n; j-- > 0;) {
    up[j] = here.total[j + 1][reflection_above] * light[j];
    if (j + 1 < here.n) up[j] += here.total[j + 1][transmission_up] * up[j + 1];
    up[j] *= here.junction[j];
  }
  PerJunction by_up = back_over_light_down(here, up, light_down(here, up), by_down, by_here);
  for (std::size_t j = 0; j < here.n; ++j) {
    const std::array<double, 4>& below = here.total[j + 1];
    const double passed = j + 1 < here.n ? up[j + 1] : 0.0;
    by_here.junction[j] +=
        by_up[j] * (below[reflection_above] * light[j] + below[transmission_up] * passed);
    const double by_sum = by_up[j] * here.junction[j];
    by_here.total[j + 1][reflection_above] += by_sum * light[j];
    if (j + 1 == here.n) continue;
    by_here.total[j + 1][transmission_up] += by_sum * passed;
    by_up[j + 1] += by_sum * below[transmission_up];
  }
}

}  // namespace lamina::detail
