// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lamina/layers/materials/skin.h"
#include "lamina/solve/reflectance/cubic_table.h"
#include "lamina/solve/reflectance/skin_reflectance_table.h"

namespace lamina {

/// How much uniform skin reflects at given wavelengths as a function of the absorption of its two
/// layers alone, with scattering and thickness fixed: SkinReflectanceTable drawn up for millions of
/// places, at some 20 ns each. Between nodes it is within 1e-4 of that table.
class LocalReflectance {
 public:
  /// @param table  of skin_fit_range of the skin
  /// @param skin   gives all but the absorption
  LocalReflectance(const SkinReflectanceTable& table, const SkinParameters& skin);

  struct Value {
    double reflectance = 0.0;
    std::array<double, 2> by_sigma_a = {};  ///< of epidermis and dermis [mm]
  };
  /// Reflected fraction of the incident light. Absorption beyond that of skin counts as the most.
  /// @param sigma_a  of epidermis and dermis [1/mm], >= 0
  [[nodiscard]] Value at(std::size_t wavelength, std::array<double, 2> sigma_a) const;

 private:
  struct Band {
    std::array<double, 2> scale;  ///< absorption to what the coordinate is of
    CubicTable<1> logarithms;
  };
  std::vector<Band> bands_;
};

}  // namespace lamina
