// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace lamina {

/// A pure substance that absorbs, as layers in files know it.
struct Chromophore {
  std::string_view name;                    ///< as in files
  double (*absorption)(double wavelength);  ///< [1/mm] at a wavelength [nm]
  double shortest, longest;                 ///< wavelengths that are known [nm]
};

/// All chromophores that files know by name: those of the skin recipe, and water.
[[nodiscard]] std::span<const Chromophore> chromophores();

}  // namespace lamina
