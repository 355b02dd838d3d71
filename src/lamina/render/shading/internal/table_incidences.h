// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "lamina/scattering/adding_doubling/adding_doubling.h"

namespace lamina {

/// The directions outside of a table at the cosines i / (nodes - 1). Nothing enters along the
/// surface, for which grazing light stands.
[[nodiscard]] inline std::vector<Incidence> table_incidences(std::size_t nodes) {
  constexpr double grazing = 0.02;
  std::vector<Incidence> incidences;
  for (std::size_t i = 0; i < nodes; ++i)
    incidences.push_back({.theta = std::acos(std::max(
                              grazing, static_cast<double>(i) / static_cast<double>(nodes - 1)))});
  return incidences;
}

}  // namespace lamina
