// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace lamina {

/// A measured curve at evenly spaced wavelengths [nm].
struct EvenTable {
  double first;
  double step;
  std::vector<double> values;
};

/// Linear between the entries, constant beyond the ends.
[[nodiscard]] inline double interpolate(const EvenTable& table, double wavelength) {
  const double x = (wavelength - table.first) / table.step;
  if (!(x > 0.0)) return table.values.front();
  const auto i = static_cast<std::size_t>(x);
  if (i + 1 >= table.values.size()) return table.values.back();
  const double t = x - static_cast<double>(i);
  return (1.0 - t) * table.values[i] + t * table.values[i + 1];
}

/// Decadic molar extinction [1/(cm mol/L)]: of hemoglobin per tetramer of 64 500 g/mol, 350-1000
/// nm; of beta-carotene (536.87 g/mol) in hexane, 350-700 nm, 0 beyond 560 nm.
extern const EvenTable oxyhemoglobin_extinction;
extern const EvenTable deoxyhemoglobin_extinction;
extern const EvenTable carotene_extinction;

}  // namespace lamina
