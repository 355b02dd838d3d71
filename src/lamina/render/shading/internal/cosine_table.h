// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/base/spectrum/band_values.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {

/// Tables of what layers do to light by its direction: at the cosines i / (cosine_nodes - 1).
inline constexpr std::size_t cosine_nodes = 17;

/// The directions outside of a table. Nothing enters along the surface, for which grazing light
/// stands.
[[nodiscard]] inline std::vector<Incidence> table_incidences() {
  constexpr double grazing = 0.02;
  std::vector<Incidence> incidences;
  for (std::size_t i = 0; i < cosine_nodes; ++i)
    incidences.push_back(
        {.theta = std::acos(std::max(grazing, static_cast<double>(i) / (cosine_nodes - 1.0)))});
  return incidences;
}

/// Where a cosine lies in a table: between a node and the next one.
struct TablePlace {
  std::size_t node = 0;
  float blend = 0.0f;  ///< of the next one
};

/// @param cosine  clamped to [0, 1]
[[nodiscard]] inline TablePlace table_place(float cosine) {
  const float x = std::clamp(cosine, 0.0f, 1.0f) * static_cast<float>(cosine_nodes - 1);
  const auto node = std::min(static_cast<std::size_t>(x), cosine_nodes - 2);
  return {node, x - static_cast<float>(node)};
}

template <int N>
[[nodiscard]] BandValues<N> mix(const BandValues<N>& a, const BandValues<N>& b, float blend) {
  return a + blend * (b - a);
}

/// a b / mean, the separable form that is symmetric and keeps the flux; 0 where nothing is.
template <int N>
[[nodiscard]] BandValues<N> separable(const BandValues<N>& a, const BandValues<N>& b,
                                      const BandValues<N>& mean) {
  BandValues<N> value;
  for (int i = 0; i < N; ++i) value[i] = mean[i] > 0.0f ? a[i] * b[i] / mean[i] : 0.0f;
  return value;
}

}  // namespace lamina
